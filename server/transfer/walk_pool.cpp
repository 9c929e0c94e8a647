#include "server/transfer/walk_pool.hpp"

#include <cstddef>

#include "server/transfer/shape_tracker.hpp"

namespace kinship::transfer {
namespace {}  // namespace

WalkPool::WalkPool(const ArmPair& pair)
    : lanes_(pair),
      space_(pair.target()),
      found_(Eigen::MatrixXd::Zero(pair.target().dof(), ShapeLanes::kCount)) {}

void WalkPool::run(const std::vector<ShapeTracker*>& trackers) {
  for (ShapeTracker* tracker : trackers)
    for (Walk& walk : tracker->begin_round())
      waiting_.push_back(std::move(walk));
  for (fill(); walking_ != 0; fill())
    look_at(lanes_.run());
}

void WalkPool::fill() {
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane)
    while (!has_lane(walking_, lane) && !waiting_.empty()) {
      walks_[static_cast<std::size_t>(lane)] = std::move(waiting_.front());
      waiting_.pop_front();
      walking_ |= lane_bit(lane);
      if (!go_on(lane))
        end_walk(lane);
    }
}

bool WalkPool::go_on(int lane) {
  const Walk& walk = walks_[static_cast<std::size_t>(lane)];
  const ShapeTracker& tracker = *walk.tracker;
  const Eigen::Index to = walk.pose + walk.direction;
  if (to < 0 || to >= tracker.poses().size())
    return false;
  lanes_.aim(lane, tracker.poses().T_base_transfer[static_cast<std::size_t>(to)],
             tracker.poses().source_shapes[static_cast<std::size_t>(to)]);
  lanes_.put(lane, walk.q);
  if (walk.direction == 0)
    lanes_.begin_pull(lane, tracker.start_steps());
  else
    lanes_.begin_step(lane, tracker.most_motion(walk), tracker.steps());
  return true;
}

void WalkPool::look_at(const ShapeLanes::Ended& ended) {
  unsigned right = 0;
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
    if (!has_lane(ended.arrived, lane))
      continue;
    found_.col(lane) = lanes_.at(lane);
    if (space_.normalize(found_.col(lane).data()))
      right |= lane_bit(lane);
  }
  right = lanes_.verified(right, found_);
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
    if (!has_lane(ended.arrived | ended.failed, lane))
      continue;
    Walk& walk = walks_[static_cast<std::size_t>(lane)];
    const bool taken =
        has_lane(right, lane) && walk.tracker->take(walk, lanes_.at(lane), found_.col(lane));
    if (!taken || walk.direction == 0 || !go_on(lane))
      end_walk(lane);
  }
}

void WalkPool::end_walk(int lane) {
  const Walk& walk = walks_[static_cast<std::size_t>(lane)];
  walking_ &= ~lane_bit(lane);
  for (Walk& next : walk.tracker->end(walk))
    waiting_.push_back(std::move(next));
}

}  // namespace kinship::transfer
