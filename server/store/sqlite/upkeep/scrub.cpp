#include "server/store/sqlite/upkeep/scrub.hpp"

#include <sqlite3.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kRowsOfASlice = 1000;
constexpr std::chrono::seconds kBetweenLines{60};
constexpr std::chrono::milliseconds kIdle{1000};
constexpr std::chrono::milliseconds kRest{10'000};  // between two passes

std::string describe(const std::vector<std::string>& found) {
  constexpr std::size_t kNamed = 4;
  std::string words;
  for (std::size_t i = 0; i < std::min(found.size(), kNamed); ++i)
    words += (i == 0 ? "" : ", ") + found[i];
  if (found.size() > kNamed)
    words += " and " + std::to_string(found.size() - kNamed) + " more";
  return words;
}

/// Bytes that a connection read from the file, or from the WAL, since the last call.
std::size_t bytes_read(Database& database) {
  int pages = 0, highest = 0;
  sqlite3_db_status(&database.connection(), SQLITE_DBSTATUS_CACHE_MISS, &pages, &highest, 1);
  return static_cast<std::size_t>(pages) *
         static_cast<std::size_t>(database.integer("PRAGMA page_size"));
}

}  // namespace

Scrub::Scrub(ReaderPool& readers, Writer& writer, ScrubOptions options)
    : readers_(&readers),
      writer_(&writer),
      options_(std::move(options)),
      thread_([this] { run(); }) {}

Scrub::~Scrub() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (searched_ != nullptr)  // the check of a structure reads a whole table
      sqlite3_interrupt(&searched_->connection());
  }
  wake_.notify_all();
  thread_.join();
}

ScrubProgress Scrub::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::string Scrub::findings() const {
  const std::lock_guard lock(mutex_);
  std::string words;
  for (const auto& [table, found] : findings_)
    words += (words.empty() ? "table " : "; table ") + table + ": " + found;
  return words;
}

void Scrub::run() {
  constexpr int kNiceness = 15;
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of this thread; refused, it runs as others do
  while (options_.bytes_per_s > 0) {
    std::chrono::milliseconds pause = kIdle;
    try {
      pause = step();
      log_news();
    } catch (const Failure&) {
      // The store is being opened again, or cannot be read at all, which its readers say.
    } catch (const std::bad_alloc&) {
      // The slice is read again.
    }
    std::unique_lock lock(mutex_);
    if (wake_.wait_for(lock, pause, [this] { return stopping_; }))
      return;
  }
}

/// While it lives the connection is interrupted when the search is to end.
class Scrub::Searching {
 public:
  Searching(Scrub& scrub, Database& database) : scrub_(&scrub) { set(&database); }
  Searching(const Searching&) = delete;
  Searching& operator=(const Searching&) = delete;
  ~Searching() { set(nullptr); }

 private:
  void set(Database* database) {
    const std::lock_guard lock(scrub_->mutex_);
    scrub_->searched_ = scrub_->stopping_ ? nullptr : database;
  }

  Scrub* scrub_;
};

std::chrono::milliseconds Scrub::step() {
  std::size_t bytes = 0;
  {
    const ReaderPool::Lease database = readers_->lease();
    static_cast<void>(bytes_read(*database));
    if (table_ == 0 && last_id_ == 0 && !is_structure_checked_)
      tables_ = tables_of(*database);
    const Searching searching(*this, *database);
    search(*database);
    bytes = bytes_read(*database);
  }
  const std::lock_guard lock(mutex_);
  progress_.part =
      tables_.empty() ? 1 : static_cast<double>(table_) / static_cast<double>(tables_.size());
  if (table_ < tables_.size())
    return std::chrono::milliseconds(1 + 1000 * bytes / options_.bytes_per_s);
  table_ = 0;
  progress_.ended_ms = now_ms();
  return kRest;
}

/// The next slice.
void Scrub::search(Database& database) {
  if (table_ == tables_.size())
    return;
  const std::string& table = tables_[table_];
  try {
    if (!is_structure_checked_) {
      found_ = check_structure(database, table);
      is_structure_checked_ = true;
      return;
    }
    if (!search_rows(database, table))
      return;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    found_.emplace_back(error.what());
  }
  note(table, std::move(found_));
  found_.clear();
  is_structure_checked_ = false;
  last_id_ = 0;
  ++table_;
}

/// \return whether these were the last ones.
bool Scrub::search_rows(Database& database, const std::string& table) {
  RowsChecked part = check_rows(database, table, last_id_, kRowsOfASlice);
  last_id_ = part.last_id;
  for (const std::string& row : part.damaged)
    found_.push_back("row " + row + " (checksum)");
  if ((has_quarantine(table) || is_dropped_if_damaged(table)) && !part.damaged_ids.empty())
    writer_->submit(std::make_unique<DamageItem>(table, std::move(part.damaged_ids)));
  return part.is_last;
}

void Scrub::note(const std::string& table, std::vector<std::string> found) {
  const std::string words = describe(found);
  const std::lock_guard lock(mutex_);
  std::string& before = findings_[table];
  is_news_ = is_news_ || (!words.empty() && words != before);
  before = words;
  if (words.empty())
    findings_.erase(table);
}

/// Once for a burst: damage found soon after waits for the next line.
void Scrub::log_news() {
  const auto now = std::chrono::steady_clock::now();
  if (!is_news_ || now < next_line_)
    return;
  is_news_ = false;
  next_line_ = now + kBetweenLines;
  if (options_.log)
    options_.log("damaged: " + findings());
}

}  // namespace kinship::store
