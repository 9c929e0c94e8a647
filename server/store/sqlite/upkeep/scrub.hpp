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

/// How far the search for damage is.
struct ScrubProgress {
  double part = 0;            ///< of the file, 0 to 1
  std::int64_t ended_ms = 0;  ///< when it was last through; 0: never
};

/// A thread of low priority that reads the pages of a store's file again and again, at a bounded
/// rate, and looks up what the damaged ones belong to, whoever found them. It reads the file past
/// SQLite's snapshots, so that it holds up no checkpoint; a page that looks damaged is read again
/// by the writer's thread, which alone writes pages, before it counts.
class Scrub {
 public:
  /// \param readers, writer  live longer.
  Scrub(ReaderPool& readers, Writer& writer, std::shared_ptr<PageDamage> damage,
        ScrubOptions options);
  Scrub(const Scrub&) = delete;
  Scrub& operator=(const Scrub&) = delete;
  ~Scrub();

  ScrubProgress progress() const;

  /// What is damaged, in words: pages and what they belong to. Empty: nothing was found.
  std::string findings() const;

 private:
  void run();
  /// \return how long to wait before the next step.
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
