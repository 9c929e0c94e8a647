#include "server/store/sqlite/upkeep/file_watch.hpp"

#include <fcntl.h>

#include <optional>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/files/leftovers.hpp"
#include "server/store/sqlite/files/store_file.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// Whether the file itself, wherever it is now, has everything.
bool fold_wal(Database& writer) {
  try {
    return checkpoint(writer, CheckpointKind::Whole);
  } catch (const SqliteError&) {
    return false;  // the copy reads the WAL
  }
}

/// Copies what a connection reads; no file of the name is touched.
/// \return why it cannot; empty: done.
std::string try_copy(Database& source, const fs::path& target) {
  try {
    const files::File made(target, O_RDWR | O_CREAT | O_EXCL, 0600);
  } catch (const files::FileError& error) {
    return error.what();
  }
  try {
    copy_database(source, target, [](double) {});
    files::sync_file(target);
    files::sync_folder_of(target);
    return {};
  } catch (const Failure& failure) {
    std::error_code none;
    fs::remove(target, none);
    return quoted(target) + ": " + failure.what();
  }
}

}  // namespace

FileWatch::FileWatch(fs::path file, const StoreLock& lock, ReaderPool& readers,
                     std::function<void(std::string_view)> log)
    : file_(std::move(file)),
      readers_(readers),
      log_(std::move(log)),
      named_(file_, lock.file().value()) {}

std::string FileWatch::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

void FileWatch::log(const std::string& line) const {
  if (log_)
    log_(line);
}

void FileWatch::tell(const NamedStore::Finding& found, const std::string& saved) {
  std::string trouble = quoted(file_) + " is not the file any more: " + found.text + "; " + saved;
  {
    const std::lock_guard lock(mutex_);
    if (trouble == trouble_)
      return;
    trouble_ = trouble;
  }
  log("not writable: " + trouble);
}

void FileWatch::note_opened() {
  named_.note_opened();
  saved_.clear();
  {
    const std::lock_guard lock(mutex_);
    if (trouble_.empty())
      return;
    trouble_.clear();
  }
  log(quoted(file_) + " is the file again: reports are taken");
}

void FileWatch::require_named(Database& writer) {
  const NamedStore::Finding found = named_.look();
  if (found.change == StoreChange::None)
    return;
  tell(found, "what can be saved of it is being saved");
  readers_.refuse(trouble());
  saved_ = save(writer, found);
  tell(found, saved_);
  throw NotTheFile(trouble());
}

void FileWatch::require_named_closed() {
  const NamedStore::Finding found = named_.look_closed();
  if (found.change == StoreChange::None)
    return;
  tell(found, saved_.empty() ? "it was closed before, so that nothing could be saved" : saved_);
  readers_.refuse(trouble());
  throw NotTheFile(trouble());
}

/// \return what was saved, and what to do.
std::string FileWatch::save(Database& writer, const NamedStore::Finding& found) {
  switch (found.change) {
    case StoreChange::None:
      return {};
    case StoreChange::FolderGone:
      return "bring the folder back, and kinshipd goes on";
    case StoreChange::Truncated:
      return copy(writer, found.change);
    case StoreChange::FileGone:
      static_cast<void>(fold_wal(writer));
      return copy(writer, found.change);
    case StoreChange::WalGone:
    case StoreChange::WalReplaced:
      if (!fold_wal(writer))
        return copy(writer, found.change);
      return "the store itself has all reports" +
             std::string(found.change == StoreChange::WalReplaced
                             ? "; put that file away, and kinshipd goes on"
                             : "");
  }
  return {};
}

std::string FileWatch::copy(Database& writer, StoreChange change) {
  const std::string name = file_.filename().string() + ".rescued-" + time_stamp();
  std::vector<fs::path> folders;
  if (const fs::path folder = named_.folder_now(); !folder.empty())
    folders.push_back(folder);
  for (fs::path folder = file_.parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    folders.push_back(folder);
  std::string why;
  for (const fs::path& folder : folders) {
    const std::string failed = try_copy(writer, folder / name);
    if (failed.empty()) {
      const std::string copy = quoted(folder / name);
      const std::string restore =
          "'kinshipd restore --store " + file_.string() + " " + (folder / name).string() + "'";
      if (change == StoreChange::Truncated)
        return "what is left of it is in " + copy + ": stop kinshipd, 'kinshipd repair --store " +
               (folder / name).string() + "', then " + restore;
      return "all of it is in " + copy + ": put the file back, and kinshipd goes on, or stop it, " +
             restore;
    }
    why += (why.empty() ? "" : "; ") + failed;
  }
  return "nothing could be saved: " + why;
}

}  // namespace kinship::store
