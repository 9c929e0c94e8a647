#pragma once

#include <filesystem>
#include <optional>

#include "proto/files/file.hpp"
#include "server/store/sqlite/opening/run_log.hpp"

namespace kinship::store {

/// FILE.witness: how far the store beside it had come, so that the next server notices if the file
/// was put back meanwhile. Written after each commit and never synced: it may fall behind the store
/// in a power cut, never ahead of it. One that cannot be written is no failure.
class WitnessFile {
 public:
  struct Testimony {
    Uuid epoch;
    HistoryPoint point;
  };

  explicit WitnessFile(const std::filesystem::path& store_file);

  std::optional<Testimony> read() const;  ///< empty if there is none, or it is damaged
  void write(const Testimony& testimony) const;

  /// For who puts another store in the place of one.
  static void remove(const std::filesystem::path& store_file);

 private:
  std::optional<files::File> file_;
};

}  // namespace kinship::store
