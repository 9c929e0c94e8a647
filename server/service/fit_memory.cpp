#include "server/service/fit_memory.hpp"

#include <utility>

namespace kinship::service {

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

FitMemory::Remains FitMemory::find(const Digest& id) {
  const std::lock_guard lock(mutex_);
  const auto known = index_.find(id);
  if (known == index_.end())
    return nullptr;
  nodes_.splice(nodes_.begin(), nodes_, known->second);
  return known->second->remains;
}

void FitMemory::put(const Digest& id, Remains remains) {
  const std::size_t bytes = size_of(remains->paths);
  const std::lock_guard lock(mutex_);
  if (const auto known = index_.find(id); known != index_.end())
    drop(known->second);
  if (bytes > max_bytes_)
    return;
  nodes_.push_front({id, std::move(remains), bytes});
  index_.emplace(id, nodes_.begin());
  bytes_ += bytes;
  while (bytes_ > max_bytes_)
    drop(std::prev(nodes_.end()));
}

void FitMemory::erase(const Digest& id) {
  const std::lock_guard lock(mutex_);
  if (const auto known = index_.find(id); known != index_.end())
    drop(known->second);
}

std::size_t FitMemory::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void FitMemory::drop(std::list<Node>::iterator node) {
  bytes_ -= node->bytes;
  index_.erase(node->id);
  nodes_.erase(node);
}

}  // namespace kinship::service
