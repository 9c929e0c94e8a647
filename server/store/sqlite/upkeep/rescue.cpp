#include "server/store/sqlite/upkeep/rescue.hpp"

#include <fcntl.h>

#include <new>
#include <stdexcept>
#include <system_error>
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
bool fold_wal(Database& lost) {
  try {
    return checkpoint(lost, CheckpointKind::Whole);
  } catch (const SqliteError&) {
    return false;  // the copy reads the WAL
  }
}

/// Runs `fill` on a new file. \return why it failed, and the file is gone; empty: it is durable.
template <typename Fill>
std::string try_new(const fs::path& target, Fill fill) {
  try {
    const files::File made(target, O_RDWR | O_CREAT | O_EXCL, 0600);
  } catch (const files::FileError& error) {
    return error.what();
  }
  std::error_code none;
  try {
    fill();
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

/// Copies what a connection reads; no file of the name is touched.
std::string try_copy(Database& source, const fs::path& target) {
  return try_new(target, [&] { copy_database(source, target, [](double) {}); });
}

void copy_bytes(const files::File& from, const files::File& to) {
  constexpr std::size_t kBytesOfAStep = std::size_t{1} << 20U;
  std::string bytes(kBytesOfAStep, '\0');
  std::uint64_t place = 0;
  while (const std::size_t size = from.read(bytes.data(), bytes.size(), place)) {
    to.write(std::string_view(bytes).substr(0, size), place);
    place += size;
  }
}

/// What SQLite would make of the files after a crash: the transactions of the WAL up to the first
/// frame that is not as it was written. Those that the file has already are not put on it again
/// unless all are there: they are older than what it has.
void copy_files(const LostStore& store, const fs::path& target) {
  const files::File copy(target, O_RDWR);
  copy_bytes(store.named.file(), copy);
  if (!store.index || store.named.wal() == nullptr)
    return;
  std::uint64_t whole = 0, pages = 0;
  WalFrames frames(*store.named.wal(), *store.index);
  frames.advance(store.index->frames, [&](const WalFrames::Frame& frame) {
    if (frame.database_pages == 0)
      return;
    whole = frames.read();
    pages = frame.database_pages;
  });
  if (whole == 0 || whole < store.index->moved)
    return;
  WalFrames(*store.named.wal(), *store.index).advance(whole, [&](const WalFrames::Frame& frame) {
    copy.write(frame.content, (frame.page - 1) * store.index->page_bytes);
  });
  copy.resize(pages * store.index->page_bytes);
}

/// Attempts of a copy whose checksum is right; nothing if a page of them cannot be read.
std::optional<std::uint64_t> intact_attempts(const fs::path& copy) try {
  Database database(copy, Access::AtRest);
  return static_cast<std::uint64_t>(database.integer(
      "SELECT count(*) FROM attempt NOT INDEXED WHERE " + database.is_intact("attempt")));
} catch (const SqliteError&) {
  return std::nullopt;
} catch (const std::logic_error&) {  // another program's tables
  return std::nullopt;
}

struct Salvage {
  std::string failed;  ///< empty: there is a copy
  std::optional<std::uint64_t> attempts;
};

/// Makes the better of two copies: what SQLite reads through the connection, which still has pages
/// in memory, and what the files have.
Salvage salvage(Database& lost, const LostStore& store, const fs::path& target) {
  Salvage best{try_copy(lost, target), {}};
  if (best.failed.empty())
    best.attempts = intact_attempts(target);
  if (best.attempts >= store.attempts)
    return best;
  const fs::path other = target.string() + ".files";
  Salvage of_files{try_new(other, [&] { copy_files(store, other); }), {}};
  if (!of_files.failed.empty())
    return best.failed.empty() ? best : of_files;
  of_files.attempts = intact_attempts(other);
  if (best.failed.empty() && best.attempts > of_files.attempts) {
    fs::remove(other);
    return best;
  }
  fs::rename(other, target);
  return of_files;
}

/// Whether SQLite may not read all any more.
bool is_damaged(const LostStore& store) {
  return is_of_content(store.change) && store.change != StoreChange::WalSpent;
}

std::string describe_copy(const LostStore& store, const Salvage& made, const fs::path& copy) {
  const std::string restore =
      "'kinshipd restore --store " + store.file.string() + " " + copy.string() + "'";
  if (store.change == StoreChange::WalSpent)
    return "all of it is in " + quoted(copy) + ": stop kinshipd, " + restore;
  if (!is_damaged(store))
    return "all of it is in " + quoted(copy) +
           ": put the file back, and kinshipd goes on, or stop it, " + restore;
  const std::string attempts =
      made.attempts ? std::to_string(*made.attempts) : "an unknown number of";
  return "what is left of it is in " + quoted(copy) + ", " + attempts + " attempts where " +
         std::to_string(store.attempts) +
         " were acknowledged: stop kinshipd, 'kinshipd repair --store " + copy.string() +
         "', then " + restore + "; clients offer again what they still keep";
}

Rescue copy_into(Database& lost, const LostStore& store, const std::vector<fs::path>& folders) {
  const std::string name = store.file.filename().string() + ".rescued-" + time_stamp();
  std::string why;
  for (const fs::path& folder : folders) {
    const fs::path copy = folder / name;
    const Salvage made =
        is_damaged(store) ? salvage(lost, store, copy) : Salvage{try_copy(lost, copy), {}};
    if (made.failed.empty())
      return {.is_saved = true, .text = describe_copy(store, made, copy)};
    why += (why.empty() ? "" : "; ") + made.failed;
  }
  return {.text = "nothing could be saved yet: " + why +
                  "; make room, it is tried again every 3 s; until kinshipd ends " +
                  store.named.open_files() + " have what is left"};
}

/// A WAL with all frames, of which some have other bytes than SQLite wrote. At the next start
/// SQLite would pass over all transactions from the first such frame on, without a word.
bool has_wrong_frames(const LostStore& store) {
  return store.change == StoreChange::WalDamaged && store.index && store.named.wal() != nullptr &&
         store.named.wal()->size() >= WalFrames::bytes_of(*store.index);
}

}  // namespace

Rescue rescue(Database& lost, const LostStore& store) {
  if (store.change == StoreChange::FolderGone)
    return {.is_saved = true, .text = "bring the folder back, and kinshipd goes on"};
  const bool is_whole = !is_damaged(store) && fold_wal(lost);
  if (is_whole && store.change == StoreChange::FileGone && store.named.has_name())
    return {true, true, "all of it is there: put it back, and kinshipd goes on"};
  if (is_whole && store.named.has_name())
    return {true, true,
            "the store itself has all reports" +
                std::string(store.change == StoreChange::WalReplaced
                                ? "; put that file away, and kinshipd goes on"
                                : "")};
  std::vector<fs::path> folders;
  if (const fs::path folder = store.named.folder_now(); !folder.empty())
    folders.push_back(folder);
  for (fs::path folder = store.file.parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    folders.push_back(folder);
  const Rescue saved = copy_into(lost, store, folders);
  if (saved.is_saved && has_wrong_frames(store))
    fold_wal(lost);  // the rows that they spoil are named by their checksums, the others are there
  return saved;
}

}  // namespace kinship::store
