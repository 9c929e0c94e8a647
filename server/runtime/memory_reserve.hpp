#pragma once

#include <cstdint>

namespace kinship::runtime {

/// From now on a request for memory that the system refuses (operator new) is counted, and throws
/// std::bad_alloc as ever; the first one gives up a reserve of address space, so that the libraries
/// in C, which end the process when they are refused, find some. An end of that kind says in a line
/// on stderr what it is. Once per process.
void keep_memory_reserve();

/// Takes the reserve again if there is more than enough room for it. To be called now and then.
void renew_memory_reserve();

std::uint64_t take_memory_refusals();  ///< since the last call

}  // namespace kinship::runtime
