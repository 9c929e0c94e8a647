#pragma once

#include <filesystem>
#include <optional>

#include "proto/files/file.hpp"
#include "server/store/sqlite/opening/run_log.hpp"

namespace kinship::store {

/// FILE.witness, the high-water mark: the last point of the store beside it, so that the next
/// server notices if the file was rolled back meanwhile. Written after each commit and never
/// synced: after a power cut it may be behind the store, never ahead of it. A failed write is
/// ignored.
class WitnessFile {
 public:
  struct Testimony {
    Uuid epoch;
    HistoryPoint point;
  };

  explicit WitnessFile(const std::filesystem::path& store_file);

  std::optional<Testimony> read() const;  ///< empty if it is missing or damaged
  void write(const Testimony& testimony) const;

  /// To be called before another store takes the file's place.
  static void remove(const std::filesystem::path& store_file);

 private:
  std::optional<files::File> file_;
};

}  // namespace kinship::store
