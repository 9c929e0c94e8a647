#include "server/store/sqlite/upkeep/file_watch.hpp"

#include <fcntl.h>

#include <exception>
#include <new>
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
  std::error_code none;
  try {
    copy_database(source, target, [](double) {});
    files::sync_file(target);
    files::sync_folder_of(target);
    return {};
  } catch (const Failure& failure) {
    fs::remove(target, none);
    return quoted(target) + ": " + failure.what();
  } catch (const std::bad_alloc&) {
    fs::remove(target, none);
    throw;
  }
}

}  // namespace

FileWatch::FileWatch(fs::path file, const StoreLock& lock, ReaderPool& readers,
                     std::function<void(std::string_view)> log)
    : file_(std::move(file)),
      readers_(readers),
      log_(std::move(log)),
      named_(file_, lock.file().value()) {}

FileWatch::~FileWatch() {
  next_try_ = {};
  try {
    if (lost_)
      save_lost(named_.look());
  } catch (const std::exception&) {
    // The log has what could not be saved, as of the try before.
  }
}

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

void FileWatch::note_opened() { named_.note_opened(); }

void FileWatch::require_named() {
  const NamedStore::Finding found = named_.look();
  if (found.change == StoreChange::None)
    return;
  tell(found, "what can be saved of it is being saved");
  readers_.refuse(trouble());
  throw NotTheFile(trouble());
}

void FileWatch::keep(std::unique_ptr<Database> lost) {
  lost_ = std::move(lost);
  next_try_ = {};
}

void FileWatch::require_named_closed() {
  if (lost_)
    save_lost(named_.look());
  const NamedStore::Finding found = lost_ ? named_.look() : named_.look_closed();
  if (found.change != StoreChange::None) {
    tell(found, saved_.empty() ? "it was closed before, so that nothing could be saved" : saved_);
    readers_.refuse(trouble());
    throw NotTheFile(trouble());
  }
  lost_.reset();
  saved_.clear();
  {
    const std::lock_guard lock(mutex_);
    if (trouble_.empty())
      return;
    trouble_.clear();
  }
  log(quoted(file_) + " is the file again");
}

/// A file that is back has all itself.
void FileWatch::save_lost(const NamedStore::Finding& found) {
  constexpr std::chrono::seconds kPause{3};
  if (found.change == StoreChange::None || std::chrono::steady_clock::now() < next_try_)
    return;
  saved_ = save(found);
  tell(found, saved_);
  next_try_ = std::chrono::steady_clock::now() + kPause;
}

/// Closes the connection once all is saved. \return what was saved, and what to do.
std::string FileWatch::save(const NamedStore::Finding& found) {
  if (found.change == StoreChange::FolderGone) {
    lost_.reset();
    return "bring the folder back, and kinshipd goes on";
  }
  const bool is_whole = found.change != StoreChange::Truncated && fold_wal(*lost_);
  if (found.change == StoreChange::Truncated || !is_whole || !named_.has_name())
    return copy(found.change);
  lost_.reset();
  if (found.change == StoreChange::FileGone)
    return "all of it is there: put it back, and kinshipd goes on";
  return "the store itself has all reports" +
         std::string(found.change == StoreChange::WalReplaced
                         ? "; put that file away, and kinshipd goes on"
                         : "");
}

std::string FileWatch::copy(StoreChange change) {
  std::vector<fs::path> folders;
  if (const fs::path folder = named_.folder_now(); !folder.empty())
    folders.push_back(folder);
  for (fs::path folder = file_.parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    folders.push_back(folder);
  return copy_into(folders, change);
}

std::string FileWatch::copy_into(const std::vector<fs::path>& folders, StoreChange change) {
  const std::string name = file_.filename().string() + ".rescued-" + time_stamp();
  std::string why;
  for (const fs::path& folder : folders) {
    const std::string failed = try_copy(*lost_, folder / name);
    if (!failed.empty()) {
      why += (why.empty() ? "" : "; ") + failed;
      continue;
    }
    lost_.reset();
    const std::string copy = quoted(folder / name);
    const std::string restore =
        "'kinshipd restore --store " + file_.string() + " " + (folder / name).string() + "'";
    if (change == StoreChange::Truncated)
      return "what is left of it is in " + copy + ": stop kinshipd, 'kinshipd repair --store " +
             (folder / name).string() + "', then " + restore;
    return "all of it is in " + copy + ": put the file back, and kinshipd goes on, or stop it, " +
           restore;
  }
  return "nothing could be saved yet: " + why + "; make room, it is tried again every 3 s; until " +
         "kinshipd ends " + named_.open_files() + " have what is left";
}

}  // namespace kinship::store
