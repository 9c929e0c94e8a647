#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <stop_token>
#include <vector>

#include "robots/inverse/joint_space.hpp"
#include "server/transfer/shape_lanes.hpp"
#include "server/transfer/shape_tracker.hpp"

namespace kinship::transfer {

/// Runs the extensions of several trackers of one pair side by side: a lane whose extension has
/// ended takes the next one that waits, whichever path it belongs to. What an extension does
/// depends on itself only, so each tracker's tracks are those that it would find alone. Not shared
/// between threads.
class ExtensionPool {
 public:
  /// \param pair  outlives it.
  explicit ExtensionPool(const ArmPair& pair);

  /// Until no tracker has anything left to try.
  /// \param trackers  of the pair.
  /// \throws Stopped.
  void run(const std::vector<ShapeTracker*>& trackers, const std::stop_token& stop = {});

 private:
  /// An extension and whose it is.
  struct Errand {
    ShapeTracker* tracker = nullptr;
    TrackExtension extension;
  };

  void enqueue(ShapeTracker& tracker, std::vector<TrackExtension> extensions);
  Errand& errand(int lane) { return errands_[static_cast<std::size_t>(lane)]; }
  /// Gives lanes without an extension those that wait.
  void fill();
  /// Lets a lane make the next step of its extension. \return false: it is at the end of the path.
  bool go_on(int lane);
  /// Hands over to the trackers what lanes found.
  void hand_over();
  void end_extension(int lane);

  ShapeLanes lanes_;
  inverse::JointSpace space_;
  std::array<Errand, ShapeLanes::kCount> errands_;  // of lanes that are not idle
  std::deque<Errand> waiting_;
  Eigen::MatrixXd found_;  // dof x kCount, in the copies that stand for all
};

}  // namespace kinship::transfer
