#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "server/runtime/clock.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

enum class Of { AllTasks, TasksWithPaths };

/// " (did you mean 'load_machine'?)" with the known task nearest to a name; empty: none is near.
/// Reads names of tasks.
std::string nearest_task(const store::ExperienceStore& store, const std::string& task, Of of);

/// The nearest tasks with paths, remembered for a while: robots ask for the same task again and
/// again. May be shared between threads.
class NearestTasks {
 public:
  static constexpr std::chrono::seconds kRemembered{30};
  static constexpr std::size_t kMaxNames = 256;  ///< beyond it all are forgotten

  /// References; they outlive the object.
  NearestTasks(const store::ExperienceStore& store, const runtime::Clock& clock)
      : store_(store), clock_(clock) {}

  /// See nearest_task().
  std::string find(const std::string& task);

 private:
  struct Known {
    std::string text;
    std::chrono::steady_clock::time_point until;
  };
  const store::ExperienceStore& store_;
  const runtime::Clock& clock_;
  std::mutex mutex_;
  std::map<std::string, Known> known_;  // guarded by mutex_
};

}  // namespace kinship::catalog
