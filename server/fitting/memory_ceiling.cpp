#include "server/fitting/memory_ceiling.hpp"

#include <stdexcept>

#include "proto/types/stopped.hpp"

namespace kinship::fitting {

MemoryCeiling::Reservation MemoryCeiling::reserve(std::size_t bytes, const std::stop_token& stop) {
  if (bytes > max_bytes_)
    throw std::invalid_argument("MemoryCeiling: more than there is");
  std::unique_lock lock(mutex_);
  if (!given_back_.wait(lock, stop, [&] { return bytes <= max_bytes_ - reserved_; }))
    throw Stopped();
  reserved_ += bytes;
  return {*this, bytes};
}

void MemoryCeiling::give_back(std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    reserved_ -= bytes;
  }
  given_back_.notify_all();
}

std::size_t MemoryCeiling::reserved() const {
  const std::lock_guard lock(mutex_);
  return reserved_;
}

}  // namespace kinship::fitting
