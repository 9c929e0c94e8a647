#include "server/fitting/fit_memory.hpp"

#include <utility>

namespace kinship::fitting {

std::size_t size_of(const KnownPaths& paths) {
  constexpr std::size_t kRest = 512;  // of a path, beside its configurations
  std::size_t bytes = 0;
  for (const auto& [id, known] : paths) {
    const transfer::TransferredPath& path = *known.path;
    const auto numbers = static_cast<std::size_t>(path.configurations.size() + path.weights.size());
    const auto indices =
        static_cast<std::size_t>(path.pose_index.size() + path.solution_index.size());
    bytes += kRest + sizeof(double) * numbers + sizeof(int) * indices;
  }
  return bytes;
}

FitMemory::State FitMemory::find(const Digest& id) {
  const std::lock_guard lock(mutex_);
  const State* const known = states_.find(id);
  return known != nullptr ? *known : nullptr;
}

void FitMemory::put(const Digest& id, State warm_state) {
  const std::size_t bytes = size_of(warm_state->paths);
  const std::lock_guard lock(mutex_);
  if (bytes > max_bytes_)
    return states_.erase(id);
  states_.put(id, std::move(warm_state), bytes);
  while (states_.bytes() > max_bytes_)
    states_.drop_oldest();
}

void FitMemory::erase(const Digest& id) {
  const std::lock_guard lock(mutex_);
  states_.erase(id);
}

std::size_t FitMemory::bytes() const {
  const std::lock_guard lock(mutex_);
  return states_.bytes();
}

}  // namespace kinship::fitting
