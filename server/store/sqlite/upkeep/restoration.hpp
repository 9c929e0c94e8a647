#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// Replaces a store, whose lock the caller holds, by a copy of a backup.
///
/// The copy is written as FILE.restoring, which the next restore removes. Once checked it is
/// renamed to FILE.replaced-<time> and exchanges names with the store in one step: before that step
/// FILE is the old store, after it the new one, and a whole store is never removed.
class Restoration {
 public:
  Restoration(std::filesystem::path backup, std::filesystem::path file);
  Restoration(const Restoration&) = delete;
  Restoration& operator=(const Restoration&) = delete;
  ~Restoration();

  /// Copies, migrates and checks the backup.
  /// \throws Failure(Storage) if it has a problem; nothing is left then.
  void prepare(const std::function<void(double)>& progress);

  /// Writes a new store from all that can be read of the store itself.
  /// \return the losses; nothing is replaced yet.
  Repaired repair(const std::function<void(double)>& progress);

  Restored replace();

 private:
  void keep_audit_of_old(Database& database) const;
  void fold_old();
  std::filesystem::path name_copy() const;
  void exchange(const std::filesystem::path& replaced) const;

  std::filesystem::path backup_;
  std::filesystem::path file_;
  std::filesystem::path copy_;
  Uuid epoch_;
};

}  // namespace kinship::store
