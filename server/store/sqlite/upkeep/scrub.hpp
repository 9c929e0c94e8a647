#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/store/sqlite/database/checked_vfs.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"

namespace kinship::store {

struct ScrubOptions {
  std::size_t bytes_per_s = 0;                ///< 0: pages are not read through
  std::function<void(std::string_view)> log;  ///< a line when damage is found; may be empty
};

/// Progress of the search for damage.
struct ScrubProgress {
  double part = 0;            ///< of the file, 0 to 1
  std::int64_t ended_ms = 0;  ///< end of the last complete search; 0: never
};

/// A thread of low priority that reads all pages of a store's file repeatedly, at a bounded rate,
/// and finds the owners of damaged pages, including those that other readings found. It reads the
/// file without an SQLite snapshot, so that it delays no checkpoint; the writer's thread, which
/// alone writes pages, reads a suspect page again before it counts.
class Scrub {
 public:
  /// \param readers, writer  outlive it.
  Scrub(ReaderPool& readers, Writer& writer, std::shared_ptr<PageDamage> damage,
        ScrubOptions options);
  Scrub(const Scrub&) = delete;
  Scrub& operator=(const Scrub&) = delete;
  ~Scrub();

  ScrubProgress progress() const;

  /// Describes the damage: pages and their owners. Empty: none found.
  std::string findings() const;

 private:
  void run();
  /// \return the pause before the next step.
  std::chrono::milliseconds step();
  std::size_t read_pages();
  void confirm(const std::vector<std::uint64_t>& suspects);
  void name_pages();
  void log_news();

  ReaderPool* readers_;
  Writer* writer_;
  std::shared_ptr<PageDamage> damage_;
  const ScrubOptions options_;
  std::uint64_t next_page_ = 1;  // the thread's own, like what it found last
  std::vector<std::uint64_t> named_;
  bool is_news_ = false;
  std::chrono::steady_clock::time_point next_line_{};  // long past at first

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  ScrubProgress progress_;  // guarded by mutex_, like all below
  std::string findings_;
  bool stopping_ = false;

  std::thread thread_;  // last: starts when all the rest is there
};

}  // namespace kinship::store
