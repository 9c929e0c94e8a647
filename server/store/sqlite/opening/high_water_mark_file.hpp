#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "proto/files/file.hpp"
#include "server/store/sqlite/opening/timeline_history.hpp"

namespace kinship::store {

/// FILE.high-water-mark, the high-water mark: the last point of the store beside it, so that the
/// next server notices if the file was rolled back meanwhile. Written after each commit and never
/// synced: after a power cut it may be behind the store, never ahead of it. A failed write is
/// ignored.
class HighWaterMarkFile {
 public:
  struct Mark {
    Uuid epoch;
    LogPosition point;
  };

  /// Makes the file if it is missing.
  explicit HighWaterMarkFile(const std::filesystem::path& store_file);
  static std::string name_of(const std::filesystem::path& store_file);

  std::optional<Mark> read() const;  ///< empty if it is missing or damaged
  void write(const Mark& mark) const;

  /// To be called before another store takes the file's place.
  static void remove(const std::filesystem::path& store_file);

 private:
  std::optional<files::File> file_;
};

}  // namespace kinship::store
