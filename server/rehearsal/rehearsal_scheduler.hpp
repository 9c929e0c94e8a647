#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/result.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/fitting/memory_ceiling.hpp"
#include "server/rehearsal/rehearse.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/store.hpp"

namespace kinship::rehearsal {

/// In memory and on its way to one or many.
using SharedRehearsal = std::shared_ptr<const Rehearsal>;

/// How what rehearsals may use is divided.
struct RehearsalSchedulerOptions {
  /// Of one processor, in the mean, 0 to 1; 0: nothing is rehearsed. Where somebody waits it takes
  /// what it can get.
  double processor_fraction = 0.1;
  RehearsalOptions plan = {};
  std::size_t max_queries = 100;     ///< planned again for one robot and task
  std::size_t max_rehearsals = 256;  ///< in memory
  std::size_t max_waiters = 1024;
  /// next_deadline() is earlier than it was. Called from any thread.
  std::function<void()> wake = [] {};
  /// A line for people, without a line feed. Called on the scheduler's thread.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

/// What it has done since it was made.
struct RehearsalTotals {
  std::uint64_t done = 0, queued = 0;
  double processor_time_s = 0;
};

/// What a rehearsal is a function of, besides the store.
struct RehearsalKey {
  fitting::DistributionKey distribution;
  std::uint32_t experience_bytes = 0;  ///< of the stored ways that the robot gets
};

/// Which guide serves a robot and task best, found out before its first query: on a thread of its
/// own that yields to all others. What is known is kept until the experience has grown by a fifth
/// and ten paths, or lost one; a server that starts anew knows nothing. May be shared between
/// threads; no lock is held across the store, a plan or an answer.
class RehearsalScheduler {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  /// Called once; with nothing if nothing is known by then.
  using Done = std::function<void(const SharedRehearsal&)>;

  /// What rehearsals work with; all of it outlives the scheduler.
  struct Parts {
    const store::Store& store;
    runtime::RobotRegistry& robots;
    const runtime::Clock& clock;
    catalog::ExperienceIndex& experience;
    fitting::MemoryCeiling* memory = nullptr;  ///< of all fits together; null: no limit
  };

  RehearsalScheduler(const Parts& parts, RehearsalSchedulerOptions options);
  ~RehearsalScheduler() { stop(); }
  RehearsalScheduler(const RehearsalScheduler&) = delete;
  RehearsalScheduler& operator=(const RehearsalScheduler&) = delete;

  /// What is known; null: nothing is. Begins to rehearse if that may be out of date.
  SharedRehearsal ask(const RehearsalKey& key);
  /// The same, answered when nothing more is to come, at the deadline, or in stop(). `done` must
  /// not block.
  void wait(const RehearsalKey& key, TimePoint deadline, const Done& done);

  std::optional<TimePoint> next_deadline() const;
  void expire(TimePoint now);

  void new_experience(std::string_view task);  ///< there are new paths
  void forget(std::string_view task);          ///< paths were retired

  /// What is known of a distribution, by its id; begins nothing.
  SharedRehearsal find(const Digest& distribution) const;
  RehearsalTotals totals() const;
  std::uint64_t geometry_revision(const Digest& robot) const {
    return parts_.robots.geometry_revision(robot);
  }

  /// Answers everybody with what is known and ends the thread. A second call returns at once.
  void stop();

 private:
  struct Waiter {
    TimePoint deadline;
    Done done;
  };
  struct Entry {
    RehearsalKey key;
    SharedRehearsal known;
    std::uint64_t paths = 0;      // it was made of
    std::uint64_t looked_at = 0;  // changes of the task's experience when it was last compared
    bool is_lost = false;         // paths were retired since
    bool is_working = false;
    std::vector<Waiter> waiters;
    std::uint64_t last_used = 0;
  };
  using WaiterAnswers = std::vector<std::pair<Done, SharedRehearsal>>;

  // Under the lock.
  Entry& use(const RehearsalKey& key);
  void let_go(Entry& entry, WaiterAnswers& answers);
  void make_room();

  // On its own thread, without the lock.
  void work(const Digest& id);
  bool is_out_of_date(const RehearsalKey& key, const Entry& entry);
  void rehearse(const Digest& id, const RehearsalKey& key);
  Result<Subject> subject_of(const RehearsalKey& key);
  void keep(const Digest& id, Rehearsal rehearsal, std::uint64_t paths);
  void rest(const Digest& id, double worked_s);

  const Parts parts_;
  const RehearsalSchedulerOptions options_;
  const std::stop_source stop_source_;

  mutable std::mutex mutex_;            // guards what follows, but for the pool
  std::condition_variable_any urgent_;  // somebody waits, or all ends
  catalog::ExperienceVersions versions_;
  std::map<Digest, Entry> entries_;  // by the id of the distribution
  std::size_t waiters_ = 0;
  std::uint64_t uses_ = 0;
  RehearsalTotals totals_;
  bool is_stopping_ = false;
  runtime::WorkerPool pool_;  // last: its thread uses all of the above
};

}  // namespace kinship::rehearsal
