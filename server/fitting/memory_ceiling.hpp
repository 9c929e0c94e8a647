#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <stop_token>
#include <utility>

namespace kinship::fitting {

/// Limits the memory of all fits together: each reserves its upper bound before it begins, and
/// waits while others hold too much. May be shared between threads.
class MemoryCeiling {
 public:
  explicit MemoryCeiling(std::size_t max_bytes) : max_bytes_(max_bytes) {}
  MemoryCeiling(const MemoryCeiling&) = delete;
  MemoryCeiling& operator=(const MemoryCeiling&) = delete;

  /// Reserved memory, given back on destruction. The ceiling outlives it.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept
        : ceiling_(std::exchange(other.ceiling_, nullptr)), bytes_(other.bytes_) {}
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(ceiling_, other.ceiling_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    Reservation(const Reservation&) = delete;
    Reservation& operator=(const Reservation&) = delete;
    ~Reservation() {
      if (ceiling_ != nullptr)
        ceiling_->give_back(bytes_);
    }

   private:
    friend class MemoryCeiling;
    Reservation(MemoryCeiling& ceiling, std::size_t bytes) : ceiling_(&ceiling), bytes_(bytes) {}

    MemoryCeiling* ceiling_ = nullptr;  // null: nothing is reserved
    std::size_t bytes_ = 0;
  };

  /// Reserves memory; waits for others if necessary.
  /// \param bytes  at most max_bytes().
  /// \throws std::invalid_argument if they are more; Stopped.
  Reservation reserve(std::size_t bytes, const std::stop_token& stop);

  std::size_t max_bytes() const noexcept { return max_bytes_; }
  std::size_t reserved() const;

 private:
  void give_back(std::size_t bytes);

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;  // guards reserved_
  std::condition_variable_any given_back_;
  std::size_t reserved_ = 0;
};

}  // namespace kinship::fitting
