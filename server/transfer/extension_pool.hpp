#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <functional>
#include <stop_token>
#include <vector>

#include "robots/inverse/joint_space.hpp"
#include "server/transfer/shape_lanes.hpp"
#include "server/transfer/shape_tracker.hpp"

namespace kinship::transfer {

/// Runs the extensions of several trackers of one pair side by side: a lane whose extension has
/// ended takes the next waiting one, of any path, and if none waits the next tracker begins. An
/// extension does not depend on others, so each tracker's tracks are those that it would find
/// alone. Not shared between threads.
class ExtensionPool {
 public:
  /// Source and sink of trackers.
  struct Trackers {
    std::function<ShapeTracker*()> next;      ///< of the pair; null: there are no more
    std::function<void(ShapeTracker&)> done;  ///< called when it has no tries left
  };

  /// \param pair      outlives it.
  explicit ExtensionPool(const ArmPair& pair);

  /// Runs until there are no more trackers. \throws Stopped and exceptions of the functions; the
  /// pool is unusable after that.
  void run(const Trackers& trackers, const std::stop_token& stop = {});

 private:
  /// An extension and its tracker.
  struct Errand {
    ShapeTracker* tracker = nullptr;
    TrackExtension extension;
  };

  void enqueue(ShapeTracker& tracker, std::vector<TrackExtension> extensions);
  /// Begins trackers until an extension waits. \return whether one waits.
  bool has_waiting();
  Errand& errand(int lane) { return errands_[static_cast<std::size_t>(lane)]; }
  /// Gives waiting extensions to idle lanes.
  void fill();
  /// Begins the next step of a lane's extension. \return false: it is at the end of the path.
  bool go_on(int lane);
  /// Passes results of lanes to their trackers.
  void hand_over();
  void end_extension(int lane);

  const Trackers* trackers_ = nullptr;  // of the run
  std::stop_token stop_;
  ShapeLanes lanes_;
  inverse::JointSpace space_;
  std::array<Errand, ShapeLanes::kCount> errands_;  // of lanes that are not idle
  std::deque<Errand> waiting_;
  Eigen::MatrixXd found_;  // dof x kCount, normalised by space_
};

}  // namespace kinship::transfer
