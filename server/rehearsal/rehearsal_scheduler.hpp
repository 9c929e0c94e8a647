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
#include "proto/types/recall_library.hpp"
#include "proto/types/rehearsal.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/fitting/memory_ceiling.hpp"
#include "server/rehearsal/rehearse.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/experience_store.hpp"
#include "server/store/rehearsal_store.hpp"

namespace kinship::rehearsal {

/// Shared by the scheduler's cache and the replies that carry it.
using SharedRehearsal = std::shared_ptr<const Rehearsal>;

/// Resources of rehearsals.
struct RehearsalSchedulerOptions {
  /// Mean fraction of one processor, 0 to 1; 0: no rehearsals. Not limited while a client waits.
  double processor_fraction = 0.1;
  RehearsalOptions plan = {};
  std::size_t max_queries = 100;     ///< replanned for one robot and task
  std::size_t max_rehearsals = 256;  ///< in memory
  std::size_t max_waiters = 1024;
  /// next_deadline() is earlier than it was. Called from any thread.
  std::function<void()> wake = [] {};
  /// A line for people, without a line feed. Called on the scheduler's thread, or by the
  /// constructor.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

/// A library of paths to recall, shared likewise.
using SharedLibrary = std::shared_ptr<const RecallLibrary>;

/// Totals of a scheduler since construction.
struct RehearsalTotals {
  std::uint64_t done = 0, queued = 0;
  double processor_time_s = 0;
};

/// The inputs that determine a rehearsal, besides the store.
struct RehearsalKey {
  fitting::DistributionKey distribution;
  std::uint32_t experience_bytes = 0;  ///< of the stored pose paths that the robot gets
  Eigen::VectorXd start = {};          ///< FetchRequest::start, maybe empty
  std::optional<Eigen::Isometry3d> T_task_goal = {};  ///< of FetchRequest; of the newest request
  bool to_configuration = false;                      ///< likewise
};

/// Finds the best guide for a robot and task before its first query, and makes its library of paths
/// to recall, on a low-priority thread of its own. Both are valid until the experience has grown by
/// a fifth and ten paths, the robot's own has doubled, or a path is lost, also after a restart:
/// complete ones are in the store. At a placement that has none, those of the nearest one count; it
/// is rehearsed itself from its second request on. May be shared between threads; no lock is held
/// across the store, a plan or an answer.
class RehearsalScheduler {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  /// Called once; with null if there is no rehearsal by then.
  using Done = std::function<void(const SharedRehearsal&)>;

  /// References; they outlive the scheduler.
  struct Parts {
    const store::ExperienceStore& store;
    runtime::RobotRegistry& robots;
    const runtime::Clock& clock;
    catalog::ExperienceIndex& experience;
    fitting::MemoryCeiling* memory = nullptr;     ///< of all fits together; null: no limit
    store::RehearsalStore* rehearsals = nullptr;  ///< null: none are kept and found again
  };

  /// Begins with what the store has; one that cannot be read has none.
  RehearsalScheduler(const Parts& parts, RehearsalSchedulerOptions options);
  ~RehearsalScheduler() { stop(); }
  RehearsalScheduler(const RehearsalScheduler&) = delete;
  RehearsalScheduler& operator=(const RehearsalScheduler&) = delete;

  /// The known rehearsal; null: none. Begins a rehearsal if it may be out of date.
  SharedRehearsal ask(const RehearsalKey& key);
  /// The same, answered when the rehearsal is complete, at the deadline, or in stop(). `done` must
  /// not block.
  void wait(const RehearsalKey& key, TimePoint deadline, const Done& done);

  std::optional<TimePoint> next_deadline() const;
  void expire(TimePoint now);

  void new_experience(std::string_view task);  ///< there are new paths
  enum class Loss { Paths, Task };  ///< retired; renamed or removed: nothing known counts
  void forget(std::string_view task, Loss loss = Loss::Paths);

  /// The known library of a robot and task, at this placement or the nearest one; null: none.
  /// Begins nothing.
  SharedLibrary library(const RehearsalKey& key) const;

  /// The known rehearsal of a distribution, by its id; begins none.
  SharedRehearsal find(const Digest& distribution) const;
  RehearsalTotals totals() const;
  std::uint64_t geometry_revision(const Digest& robot) const {
    return parts_.robots.geometry_revision(robot);
  }

  /// Answers all waiters with the known rehearsal and ends the thread. A second call returns at
  /// once.
  void stop();

 private:
  /// Of paths.
  struct Counts {
    std::uint64_t all = 0;
    std::optional<std::uint64_t> own;  // the robot's; nothing: not known since a restart
  };
  struct Waiter {
    TimePoint deadline;
    Done done;
  };
  struct Entry {
    Digest id;
    RehearsalKey key;
    Digest kind;  // of the key without its placement
    SharedRehearsal known;
    SharedLibrary library;
    std::uint64_t asked = 0;
    Counts made_of;
    /// Changes of the task's experience when it was last compared; nothing: by no request yet.
    std::optional<std::uint64_t> looked_at;
    std::optional<Loss> lost;  // since it began
    bool is_working = false;
    std::vector<Waiter> waiters;
    mutable std::uint64_t last_used = 0;
  };
  using WaiterAnswers = std::vector<std::pair<Done, SharedRehearsal>>;

  void load();  // before the thread has anything to do

  // Under the lock.
  Entry& use(const RehearsalKey& key);
  SharedRehearsal known_to(const Entry& entry) const;
  enum class Worth { Enough, Any };
  const Entry* nearest(const RehearsalKey& key, Worth worth = Worth::Enough) const;
  bool is_compared(const Entry& entry) const;
  void begin(const Digest& id, Entry& entry);
  void let_go(Entry& entry, WaiterAnswers& answers);
  void make_room();

  // On its own thread, without the lock.
  void work(const Digest& id);
  Counts count_selected(const fitting::DistributionKey& key) const;
  bool is_out_of_date(const RehearsalKey& key, const Entry& entry) const;
  void rehearse(const Digest& id, const RehearsalKey& key);
  void do_in_parts(const Digest& id, const std::function<bool()>& part);
  void try_a_few(const Digest& id, const Subject& subject, RehearsalOptions plan,
                 const Counts& paths);
  Rehearsal try_guides(const Digest& id, Subject subject, const Counts& paths);
  SharedLibrary make_library(const Digest& id, const Subject& subject);
  void keep(const Digest& id, Rehearsal rehearsal, const Counts& paths);
  void save(const Digest& id, std::uint64_t retired);
  void rest(const Digest& id, double worked_s);

  const Parts parts_;
  const RehearsalSchedulerOptions options_;
  const std::stop_source stop_source_;

  mutable std::mutex mutex_;            // guards what follows, but for the pool
  std::condition_variable_any urgent_;  // a client waits, or the scheduler stops
  catalog::ExperienceVersions versions_;
  std::map<Digest, Entry> entries_;  // by the id of the distribution
  std::size_t waiters_ = 0;
  std::uint64_t uses_ = 0;
  RehearsalTotals totals_;
  bool is_stopping_ = false;
  runtime::WorkerPool pool_;  // last: its thread uses all of the above
};

}  // namespace kinship::rehearsal
