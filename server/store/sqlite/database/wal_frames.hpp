#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace kinship::store {

/// The CRC-32C of each page in a WAL file, as this process wrote or first read it. SQLite verifies
/// its own checksums of frames when it recovers a WAL, never when it reads a page from it. May be
/// shared between threads.
class WalFrames {
 public:
  /// Notes bytes being written to the file: a header, a page, or a part of one.
  void written(std::int64_t offset, std::span<const std::uint8_t> bytes);
  /// Forgets the pages of these bytes, which could not be written.
  void forget(std::int64_t offset, std::size_t size);
  void truncated(std::int64_t size);

  /// \param bytes  as read: a page, or a frame with its header.
  /// \return whether the bytes may be as written: true also for an unknown page, whose CRC is known
  ///         from then on.
  bool is_right(std::int64_t offset, std::span<const std::uint8_t> bytes);

  /// Notes that a file is opened or closed; closing the last one forgets everything.
  void opened();
  void closed();

 private:
  /// The frame whose page lies there, if it is a whole page.
  std::optional<std::size_t> frame_of_page(std::int64_t offset, std::size_t size) const;
  std::optional<std::uint32_t>& crc_at(std::size_t frame);
  void continue_page(std::int64_t offset, std::span<const std::uint8_t> bytes);

  std::mutex mutex_;
  std::size_t page_size_ = 0;                      // guarded by mutex_, like all below
  std::vector<std::optional<std::uint32_t>> crc_;  // by frame, from 0
  std::int64_t part_end_ = 0;  // where a page written in parts goes on; 0: none is
  std::uint32_t part_crc_ = 0;
  int open_ = 0;
};

}  // namespace kinship::store
