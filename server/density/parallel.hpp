#pragma once

#include <functional>

namespace kinship::density {

/// Does the parts 0 to parts - 1 of a work, each once, on up to `threads` threads (this one among
/// them). Which thread does which part is not said: results belong to parts, never to threads.
/// \param part  may run at the same time as other parts.
/// \throws what a part threw; of several the one with the lowest number. All parts are tried.
void for_each_part(int threads, int parts, const std::function<void(int)>& part);

}  // namespace kinship::density
