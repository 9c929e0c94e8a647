#pragma once

#include <cstddef>
#include <functional>

namespace kinship::experiments {

/// Calls `work` with 0, 1, ... count - 1 from several threads; each index once, in no order.
/// The first exception ends the others after the index they are at, and is thrown on.
/// \param threads  at least 1.
void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace kinship::experiments
