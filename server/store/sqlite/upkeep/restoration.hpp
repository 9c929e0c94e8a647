#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// Puts a copy of a backup in the place of a store whose lock the caller holds.
///
/// The copy grows as FILE.restoring, which the next restore removes. Once it is checked it is
/// renamed to FILE.replaced-<time> and changes names with the store in one step: before that step
/// FILE is the old store, after it the new one, and nothing that is whole is ever removed.
class Restoration {
 public:
  Restoration(std::filesystem::path backup, std::filesystem::path file);
  Restoration(const Restoration&) = delete;
  Restoration& operator=(const Restoration&) = delete;
  ~Restoration();

  /// Copies, migrates and checks the backup.
  /// \throws Failure(Storage) if it has a problem; nothing is left then.
  void prepare(const std::function<void(double)>& progress);

  /// Writes the store itself anew, from what can be read of it.
  /// \return with what was lost; nothing is replaced yet.
  Repaired repair(const std::function<void(double)>& progress);

  Restored replace();

 private:
  void keep_audit_of_old(Database& database) const;
  void fold_old();
  void set_companions_aside(const std::filesystem::path& replaced) const;
  std::filesystem::path name_copy() const;
  void exchange(const std::filesystem::path& replaced) const;

  std::filesystem::path backup_;
  std::filesystem::path file_;
  std::filesystem::path copy_;
  Uuid epoch_;
};

}  // namespace kinship::store
