#pragma once

#include <functional>

namespace kinship::density {

/// Runs the parts 0 to parts - 1 of a job, each once, on up to `threads` threads (this one among
/// them). The thread of a part is unspecified: results belong to parts, never to threads.
/// \param part  may run at the same time as other parts.
/// \throws the exception of a part; of several, that of the lowest number. All parts are tried.
void for_each_part(int threads, int parts, const std::function<void(int)>& part);

}  // namespace kinship::density
