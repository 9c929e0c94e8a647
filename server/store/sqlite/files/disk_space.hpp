#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace kinship::store {

/// The free space on the file system of a store: how much must stay free, and a ballast file beside
/// the store that is removed when none is left, because on a full disk neither a checkpoint nor a
/// DELETE works. May be shared between threads.
class DiskSpace {
 public:
  /// \param watermark_bytes  see shortage(); 0: no limit.
  /// \param ballast_bytes    size of FILE.ballast; 0: none, and that of an earlier server is
  ///                         removed.
  DiskSpace(const std::filesystem::path& file, std::uint64_t watermark_bytes,
            std::uint64_t ballast_bytes);

  /// Empty while there is room for reports; else a sentence with the file system, its free bytes
  /// and the limit.
  std::string shortage() const;
  /// Empty while the ballast exists, or none is wanted; else a sentence.
  std::string missing_ballast() const;

  /// Whether the ballast is missing and twice its size is free beside the watermark.
  bool may_take_ballast() const;
  /// Allocates the ballast if there is room for it; else there is none.
  void take_ballast();
  /// Removes the ballast if the disk is short of room.
  void release_ballast_if_short();

 private:
  std::optional<std::uint64_t> free_bytes() const;

  const std::filesystem::path directory_;
  const std::filesystem::path ballast_;
  const std::uint64_t watermark_bytes_;
  const std::uint64_t ballast_bytes_;
  std::string file_system_;  // the folder that it is mounted at
  std::atomic<bool> has_ballast_ = false;
};

}  // namespace kinship::store
