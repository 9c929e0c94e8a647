#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kinship::store {

/// Bytes for a file, gathered while each piece begins where the last one ended: SQLite writes a
/// commit to the WAL in two calls per page.
class GatheredWrites {
 public:
  /// Allocates the maximum, so that take() needs no heap.
  void reserve() { bytes_.reserve(kMaxBytes); }

  /// \return whether the piece was taken. If not, the gathered bytes must be written first.
  bool take(std::int64_t offset, std::span<const std::uint8_t> bytes) {
    if (!empty() && (offset != end() || bytes_.size() + bytes.size() > kMaxBytes))
      return false;
    if (empty())
      offset_ = offset;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }

  bool empty() const noexcept { return bytes_.empty(); }
  std::int64_t offset() const noexcept { return offset_; }
  std::span<const std::uint8_t> bytes() const noexcept { return bytes_; }
  void clear() noexcept { bytes_.clear(); }

 private:
  static constexpr std::size_t kMaxBytes = 0x1FFFF;  // SQLite's VFS for Unix writes no more at once

  std::int64_t end() const noexcept { return offset_ + std::ssize(bytes_); }

  std::vector<std::uint8_t> bytes_;
  std::int64_t offset_ = 0;  // of the first byte in the file
};

}  // namespace kinship::store
