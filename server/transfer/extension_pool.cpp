#include "server/transfer/extension_pool.hpp"

#include <cstddef>
#include <utility>

#include "proto/types/stopped.hpp"

namespace kinship::transfer {

ExtensionPool::ExtensionPool(const ArmPair& pair)
    : lanes_(pair),
      space_(pair.target()),
      found_(Eigen::MatrixXd::Zero(pair.target().dof(), ShapeLanes::kCount)) {}

void ExtensionPool::run(const Trackers& trackers, const std::stop_token& stop) {
  trackers_ = &trackers;
  stop_ = stop;
  for (fill(); lanes_.run(); fill()) {
    throw_if_stopped(stop_);
    hand_over();
  }
}

void ExtensionPool::enqueue(ShapeTracker& tracker, std::vector<TrackExtension> extensions) {
  for (TrackExtension& extension : extensions)
    waiting_.push_back({&tracker, std::move(extension)});
  if (tracker.is_idle())
    trackers_->done(tracker);
}

bool ExtensionPool::has_waiting() {
  while (waiting_.empty()) {
    throw_if_stopped(stop_);
    ShapeTracker* const tracker = trackers_->next();
    if (tracker == nullptr)
      return false;
    enqueue(*tracker, tracker->begin_round());
  }
  return true;
}

void ExtensionPool::fill() {
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane)
    while (lanes_.is_idle(lane) && has_waiting()) {
      errand(lane) = std::move(waiting_.front());
      waiting_.pop_front();
      if (!go_on(lane))
        end_extension(lane);
    }
}

bool ExtensionPool::go_on(int lane) {
  const TrackExtension& extension = errand(lane).extension;
  const ShapeTracker& tracker = *errand(lane).tracker;
  const Eigen::Index to = extension.pose + extension.direction;
  if (to < 0 || to >= tracker.poses().size())
    return false;
  lanes_.aim(lane, tracker.poses().T_base_transfer[static_cast<std::size_t>(to)],
             tracker.poses().source_shapes[static_cast<std::size_t>(to)]);
  lanes_.put(lane, extension.q);
  if (extension.direction == 0)
    lanes_.begin_pull(lane, tracker.start_steps());
  else
    lanes_.begin_step(lane, tracker.most_motion(extension), tracker.steps());
  return true;
}

void ExtensionPool::hand_over() {
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
    auto& [tracker, extension] = errand(lane);
    const bool taken =
        within[i] && right[i] && tracker->take(extension, lanes_.at(lane), found_.col(lane));
    if (!taken || extension.direction == 0 || !go_on(lane))
      end_extension(lane);
  }
}

void ExtensionPool::end_extension(int lane) {
  lanes_.rest(lane);
  auto& [tracker, extension] = errand(lane);
  enqueue(*tracker, tracker->end(extension));
}

}  // namespace kinship::transfer
