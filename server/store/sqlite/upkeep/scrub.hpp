#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"
#include "server/store/sqlite/rows/damage_search.hpp"

namespace kinship::store {

struct ScrubOptions {
  std::size_t bytes_per_s = 0;                ///< 0: nothing is searched
  std::function<void(std::string_view)> log;  ///< a line when damage is found; may be empty
};

/// Progress of the search for damage.
struct ScrubProgress {
  double part = 0;            ///< of the tables, 0 to 1
  std::int64_t ended_ms = 0;  ///< end of the last complete search; 0: never
};

/// A thread of low priority that searches a store for damage repeatedly: table by table, the
/// structure of a table in one slice, then its rows in slices of 1000, with pauses that bound the
/// rate. Damaged paths, attempts, scenes and distributions go into quarantine. A slice reads one
/// snapshot, and so delays checkpoints for as long.
class Scrub {
 public:
  /// \param readers, writer  outlive it.
  Scrub(ReaderPool& readers, Writer& writer, ScrubOptions options);
  Scrub(const Scrub&) = delete;
  Scrub& operator=(const Scrub&) = delete;
  ~Scrub();

  ScrubProgress progress() const;

  /// Describes the damage that the last look at each table found. Empty: none.
  std::string findings() const;

 private:
  class Searching;

  void run();
  /// \return the pause before the next step.
  std::chrono::milliseconds step();
  void search(Database& database);
  bool search_rows(Database& database, const std::string& table);
  void note(const std::string& table, std::vector<std::string> found);
  void log_news();

  ReaderPool* readers_;
  Writer* writer_;
  const ScrubOptions options_;
  // The thread's own, the place of the next slice:
  std::vector<std::string> tables_;
  std::size_t table_ = 0;
  bool is_structure_checked_ = false;  // of this table
  std::int64_t last_id_ = 0;           // of its rows
  std::vector<std::string> found_;     // in this table
  bool is_news_ = false;
  std::chrono::steady_clock::time_point next_line_{};  // long past at first

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  ScrubProgress progress_;                       // guarded by mutex_, like all below
  std::map<std::string, std::string> findings_;  // by table
  bool stopping_ = false;
  Database* searched_ = nullptr;  // by the slice under way

  std::thread thread_;  // last: starts when all the rest is there
};

}  // namespace kinship::store
