#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/fitting/experience_choice.hpp"
#include "server/fitting/pose_path_memory.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// The parameters that an experience depends on, besides the store; the requesting robot is none.
struct ExperienceKey {
  std::string task;
  std::vector<Digest> sources;  ///< ascending; empty: all
  std::int64_t since_ms = 0;    ///< paths received at or after, Unix time, UTC; 0: all
  std::uint32_t bytes = 0;      ///< at most

  auto operator<=>(const ExperienceKey&) const = default;
};

/// A choice, shared by the index and the replies being sent.
using SharedChoice = std::shared_ptr<const fitting::ExperienceChoice>;

/// The experience of tasks, chosen on a thread of its own, one choice at a time, so that it never
/// waits for a fit; kept until the experience changes. May be shared between threads; no lock is
/// held across the store or an answer.
class ExperienceIndex {
 public:
  struct Limits {
    /// Choices in memory. Together they take no more than paths.bytes, but the newest stays.
    std::size_t max_choices = 64;
    fitting::PosePathMemory::Limits paths = {};
    std::size_t max_waiters = 4096;
  };
  /// Called once, with nothing if the store cannot be read, too many wait or the server stops.
  using Done = std::function<void(const SharedChoice&)>;

  /// \param store, robots  outlive it.
  ExperienceIndex(const store::ExperienceStore& store, runtime::RobotRegistry& robots)
      : ExperienceIndex(store, robots, Limits{}) {}
  ExperienceIndex(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                  const Limits& limits);
  ~ExperienceIndex() { stop(); }
  ExperienceIndex(const ExperienceIndex&) = delete;
  ExperienceIndex& operator=(const ExperienceIndex&) = delete;

  /// The choice in memory, if up to date; else null.
  SharedChoice find(const ExperienceKey& key);
  /// `done` is called on this thread if the choice is in memory, else on the index's own or in
  /// stop(); it must not block. Its choice reflects all reports and retirements made before the
  /// call.
  void ask(const ExperienceKey& key, Done done);

  void new_experience(std::string_view task);  ///< there are new paths
  void forget(std::string_view task);          ///< paths were retired

  std::size_t bytes_of_paths() const noexcept { return memory_.bytes(); }  ///< in memory, about

  /// Answers all waiters, and later ones, with nothing, and ends the thread. Not to be called from
  /// a `done`. A second call returns at once.
  void stop();

 private:
  struct Waiter {
    std::uint64_t asked_at = 0;  ///< changes of the task's experience
    Done done;
  };
  struct Entry {
    SharedChoice choice;
    std::uint64_t chosen_at = 0;  ///< changes of the task's experience before it was read
    bool is_working = false;
    std::vector<Waiter> waiters;
    std::uint64_t last_used = 0;
  };

  using ChoiceAnswers = std::vector<std::pair<Done, SharedChoice>>;

  // Under the lock.
  SharedChoice find_current(const ExperienceKey& key);
  bool submit(const ExperienceKey& key);
  void let_go(Entry& entry, std::uint64_t chosen_at, const SharedChoice& choice,
              ChoiceAnswers& answers);
  void make_room();

  // On its own thread, without the lock.
  void choose(const ExperienceKey& key);
  ChoiceAnswers complete(const ExperienceKey& key, const SharedChoice& choice,
                         std::uint64_t chosen_at);

  const Limits limits_;
  const std::stop_source stop_source_;
  fitting::PosePathMemory memory_;  // of the pool's only thread

  std::mutex mutex_;  // guards what follows, but for the pool
  ExperienceVersions versions_;
  std::map<ExperienceKey, Entry> entries_;
  std::size_t waiters_ = 0;
  std::uint64_t uses_ = 0;
  bool is_stopping_ = false;
  runtime::WorkerPool pool_;  // last: its thread uses all of the above
};

}  // namespace kinship::catalog
