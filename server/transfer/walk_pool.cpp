#include "server/transfer/walk_pool.hpp"

#include <cstddef>
#include <utility>

namespace kinship::transfer {

WalkPool::WalkPool(const ArmPair& pair)
    : lanes_(pair),
      space_(pair.target()),
      found_(Eigen::MatrixXd::Zero(pair.target().dof(), ShapeLanes::kCount)) {}

void WalkPool::run(const std::vector<ShapeTracker*>& trackers) {
  for (ShapeTracker* tracker : trackers)
    enqueue(*tracker, tracker->begin_round());
  for (fill(); lanes_.run(); fill())
    hand_over();
}

void WalkPool::enqueue(ShapeTracker& tracker, std::vector<Walk> walks) {
  for (Walk& walk : walks)
    waiting_.push_back({&tracker, std::move(walk)});
}

void WalkPool::fill() {
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane)
    while (lanes_.is_idle(lane) && !waiting_.empty()) {
      errand(lane) = std::move(waiting_.front());
      waiting_.pop_front();
      if (!go_on(lane))
        end_walk(lane);
    }
}

bool WalkPool::go_on(int lane) {
  const Walk& walk = errand(lane).walk;
  const ShapeTracker& tracker = *errand(lane).tracker;
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

void WalkPool::hand_over() {
  std::array<bool, ShapeLanes::kCount> within{};
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
    if (lanes_.state(lane) != ShapeLanes::State::Arrived)
      continue;
    found_.col(lane) = lanes_.at(lane);
    within[static_cast<std::size_t>(lane)] = space_.normalize(found_.col(lane).data());
  }
  const std::array<bool, ShapeLanes::kCount> right = lanes_.verified(found_);
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
    if (!lanes_.has_ended(lane))
      continue;
    const auto i = static_cast<std::size_t>(lane);
    auto& [tracker, walk] = errand(lane);
    const bool taken =
        within[i] && right[i] && tracker->take(walk, lanes_.at(lane), found_.col(lane));
    if (!taken || walk.direction == 0 || !go_on(lane))
      end_walk(lane);
  }
}

void WalkPool::end_walk(int lane) {
  lanes_.rest(lane);
  auto& [tracker, walk] = errand(lane);
  enqueue(*tracker, tracker->end(walk));
}

}  // namespace kinship::transfer
