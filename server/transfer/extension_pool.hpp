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
/// ended takes the next one that waits, whichever path it belongs to, and where none waits the next
/// tracker begins. What an extension does depends on itself only, so each tracker's tracks are
/// those that it would find alone. Not shared between threads.
class ExtensionPool {
 public:
  /// Where trackers come from, and what becomes of them.
  struct Trackers {
    std::function<ShapeTracker*()> next;      ///< of the pair; null: there are no more
    std::function<void(ShapeTracker&)> done;  ///< called when it has nothing left to try
  };

  /// \param pair      outlives it.
  explicit ExtensionPool(const ArmPair& pair);

  /// Until there are no more trackers.
  /// \throws Stopped, and what the functions throw: then it is of no use any more.
  void run(const Trackers& trackers, const std::stop_token& stop = {});

 private:
  /// An extension and whose it is.
  struct Errand {
    ShapeTracker* tracker = nullptr;
    TrackExtension extension;
  };

  void enqueue(ShapeTracker& tracker, std::vector<TrackExtension> extensions);
  /// Begins trackers until an extension waits. \return whether one does.
  bool has_waiting();
  Errand& errand(int lane) { return errands_[static_cast<std::size_t>(lane)]; }
  /// Gives lanes without an extension those that wait.
  void fill();
  /// Lets a lane make the next step of its extension. \return false: it is at the end of the path.
  bool go_on(int lane);
  /// Hands over to the trackers what lanes found.
  void hand_over();
  void end_extension(int lane);

  const Trackers* trackers_ = nullptr;  // of the run
  std::stop_token stop_;
  ShapeLanes lanes_;
  inverse::JointSpace space_;
  std::array<Errand, ShapeLanes::kCount> errands_;  // of lanes that are not idle
  std::deque<Errand> waiting_;
  Eigen::MatrixXd found_;  // dof x kCount, in the copies that stand for all
};

}  // namespace kinship::transfer
