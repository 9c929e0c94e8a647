#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "handles.hpp"
#include "moveit_versions.hpp"
#include "settings.hpp"

namespace kinship_moveit {

/// What the server gave for a task and a placement. Members are null where it gave none.
struct Guidance {
  std::shared_ptr<const kinship_distribution> distribution;
  std::shared_ptr<const kinship_sampler> sampler;
  std::shared_ptr<kinship_recall> recall;
  double share = 0;  ///< of samples, as recommended, 0 to 1
};

/// A group of the robot model that is a chain, as a robot of Kinship. Threads share it.
class Arm {
 public:
  /// \throws std::invalid_argument that says why the group cannot be one.
  Arm(const moveit::core::RobotModel& model, const std::string& group);

  const std::string& group() const { return group_; }
  const std::string& base_link() const { return base_link_; }
  const std::string& tip_link() const { return tip_link_; }
  std::size_t dof() const { return dof_; }

  /// Registers the robot, and reads it for Kinship's planners if `plans`. Waits for the server at
  /// most Settings::timeout_ms, and may take seconds with meshes: for a thread of its own.
  /// \return what to tell people; empty: all went well.
  std::string make(kinship_client& client, const Settings& settings, bool plans);
  /// False before make(), and if it failed.
  bool is_ready() const { return is_ready_; }
  const kinship_robot& robot() const { return robot_; }                        ///< once ready
  std::shared_ptr<const kinship_planner> planner() const { return planner_; }  ///< once ready

  /// The newest; follows the 16 tasks and placements that were used last, from the first call on.
  /// Waits once per task and placement, at most Settings::first_wait_ms. \param why  out: why there
  /// is none; empty otherwise.
  Guidance guidance(kinship_client& client, const Settings& settings, const std::string& task,
                    const Eigen::Isometry3d& T_task_base, std::string& why);
  /// Follows without waiting.
  void follow(kinship_client& client, const Settings& settings, const std::string& task,
              const Eigen::Isometry3d& T_task_base);

 private:
  struct Followed {
    Owned<kinship_follower> follower;
    Guidance held;
    bool was_awaited = false;
    std::uint64_t used = 0;  // number of the query that used it last
  };
  /// To a millimetre and a milliradian, as the server has it.
  using Key = std::pair<std::string, std::array<long, 7>>;

  Followed* find(kinship_client& client, const Settings& settings, const std::string& task,
                 const Eigen::Isometry3d& T_task_base);
  static void refresh(Followed& followed, std::uint32_t wait_ms, std::string& why);

  std::string group_, base_link_, tip_link_, model_name_;
  std::size_t dof_ = 0;
  std::atomic<bool> is_ready_ = false;  // what follows is set before, and stays
  kinship_robot robot_{};
  std::shared_ptr<const kinship_planner> planner_;
  std::mutex mutex_;  // guards the next
  std::map<Key, Followed> followed_;
  std::uint64_t queries_ = 0;
};

}  // namespace kinship_moveit
