#include "server/store/sqlite/database/wal_frames.hpp"

#include <algorithm>
#include <bit>

#include "server/store/values/crc32c.hpp"

// https://sqlite.org/walformat.html: a header of 32 bytes, then frames: 24 bytes and a page.
namespace kinship::store {
namespace {

constexpr std::int64_t kWalHeaderBytes = 32;
constexpr std::int64_t kFrameHeaderBytes = 24;
constexpr std::size_t kPageSizeAt = 8;  // in the header, big-endian

std::size_t page_size_of(std::span<const std::uint8_t> header) {
  std::size_t size = 0;
  for (const std::uint8_t byte : header.subspan(kPageSizeAt, 4))
    size = size << 8U | byte;
  return std::has_single_bit(size) ? size : 0;
}

}  // namespace

std::optional<std::size_t> WalFrames::frame_of_page(std::int64_t offset, std::size_t size) const {
  if (page_size_ == 0 || size != page_size_ || offset < kWalHeaderBytes + kFrameHeaderBytes)
    return std::nullopt;
  const auto frame_size = static_cast<std::int64_t>(page_size_) + kFrameHeaderBytes;
  const std::int64_t past = offset - kWalHeaderBytes - kFrameHeaderBytes;
  if (past % frame_size != 0)
    return std::nullopt;
  return static_cast<std::size_t>(past / frame_size);
}

std::optional<std::uint32_t>& WalFrames::crc_at(std::size_t frame) {
  if (frame >= crc_.size())
    crc_.resize(frame + 1);
  return crc_[frame];
}

void WalFrames::written(std::int64_t offset, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (offset == 0 && std::ssize(bytes) == kWalHeaderBytes) {
    if (const std::size_t size = page_size_of(bytes); size != page_size_) {
      page_size_ = size;
      crc_.clear();
    }
  } else if (const auto frame = frame_of_page(offset, bytes.size())) {
    crc_at(*frame) = crc32c(bytes);
  } else {
    continue_page(offset, bytes);
  }
}

/// SQLite cuts a page where it syncs within it, if the disk may tear sectors.
void WalFrames::continue_page(std::int64_t offset, std::span<const std::uint8_t> bytes) {
  if (page_size_ == 0 || offset < kWalHeaderBytes)
    return;
  const auto frame_size = static_cast<std::int64_t>(page_size_) + kFrameHeaderBytes;
  const std::int64_t within = (offset - kWalHeaderBytes) % frame_size;
  if (within + std::ssize(bytes) <= kFrameHeaderBytes)
    return;  // of a frame's header, which only a recovery reads
  const auto frame = static_cast<std::size_t>((offset - kWalHeaderBytes) / frame_size);
  crc_at(frame).reset();
  if (within == kFrameHeaderBytes)
    part_crc_ = crc32c(bytes);
  else if (offset == part_end_)
    part_crc_ = crc32c(bytes, part_crc_);
  else
    return;  // not known, so not judged
  part_end_ = offset + std::ssize(bytes);
  if (within + std::ssize(bytes) == frame_size) {
    crc_at(frame) = part_crc_;
    part_end_ = 0;
  }
}

void WalFrames::forget(std::int64_t offset, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (page_size_ == 0)
    return;
  const auto frame_size = static_cast<std::int64_t>(page_size_) + kFrameHeaderBytes;
  const std::int64_t last = offset + static_cast<std::int64_t>(size) - 1;
  for (std::int64_t frame = std::max<std::int64_t>(0, (offset - kWalHeaderBytes) / frame_size);
       frame <= (last - kWalHeaderBytes) / frame_size; ++frame)
    crc_at(static_cast<std::size_t>(frame)).reset();
}

void WalFrames::truncated(std::int64_t size) {
  const std::lock_guard lock(mutex_);
  if (page_size_ == 0)
    return;
  const auto frame_size = static_cast<std::int64_t>(page_size_) + kFrameHeaderBytes;
  const auto left =
      static_cast<std::size_t>(std::max<std::int64_t>(0, (size - kWalHeaderBytes) / frame_size));
  if (left < crc_.size())
    crc_.resize(left);
}

bool WalFrames::is_right(std::int64_t offset, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (offset == 0 && std::ssize(bytes) >= kWalHeaderBytes) {
    if (page_size_ == 0)
      page_size_ = page_size_of(bytes);
    return true;
  }
  auto frame = frame_of_page(offset, bytes.size());
  if (!frame && std::ssize(bytes) > kFrameHeaderBytes) {
    bytes = bytes.subspan(kFrameHeaderBytes);
    frame = frame_of_page(offset + kFrameHeaderBytes, bytes.size());
  }
  if (!frame)
    return true;
  std::optional<std::uint32_t>& known = crc_at(*frame);
  const std::uint32_t crc = crc32c(bytes);
  if (!known)
    known = crc;
  return known == crc;
}

void WalFrames::opened() {
  const std::lock_guard lock(mutex_);
  ++open_;
}

void WalFrames::closed() {
  const std::lock_guard lock(mutex_);
  if (--open_ > 0)
    return;
  page_size_ = 0;
  part_end_ = 0;
  crc_.clear();
  crc_.shrink_to_fit();
}

}  // namespace kinship::store
