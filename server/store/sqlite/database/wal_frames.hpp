#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace kinship::store {

/// What this process knows of the pages that lie in a WAL file: the CRC-32C of each as it was
/// written. SQLite's own checksums of frames are looked at when a WAL is recovered, never when a
/// page is read from it. May be shared between threads.
class WalFrames {
 public:
  /// Bytes that are being written to the file: a header, a page, or a part of one.
  void written(std::int64_t offset, std::span<const std::uint8_t> bytes);
  /// Nothing is known any more of what these bytes belong to: they could not be written.
  void forget(std::int64_t offset, std::size_t size);
  void truncated(std::int64_t size);

  /// \param bytes  as read: a page, or a frame with its header.
  /// \return whether they may be what was written: yes, too, if nothing is known of them; from then
  ///         on it is known.
  bool is_right(std::int64_t offset, std::span<const std::uint8_t> bytes);

  /// A file is opened or closed; when the last one is closed everything is forgotten.
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
