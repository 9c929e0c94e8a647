#include "client/planning/experience_guide.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "client/planning/moved_path.hpp"
#include "client/planning/planning_bounds.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::planning {
namespace {

/// The configurations of a track that lie within bounds, turning joints moved by full turns.
void keep_within(const Eigen::Matrix2Xd& bounds, const std::vector<bool>& turning, Track& track) {
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < track.configurations.cols(); ++i)
    if (const auto q = turned_into(bounds, turning, track.configurations.col(i)))
      track.configurations.col(kept++) = *q;
  track.configurations.conservativeResize(Eigen::NoChange, kept);
}

}  // namespace

ExperienceGuide::ExperienceGuide(const kinematics::Chain& chain, TaskExperience experience)
    : chain_(chain), solver_(chain), experience_(std::move(experience)) {
  for (const PosePath& path : experience_.paths)
    if (path.poses.size() < 2)
      throw std::invalid_argument("ExperienceGuide: a path has less than two poses");
}

std::vector<Track> ExperienceGuide::tracks(const Eigen::Isometry3d& T_task_base,
                                           const Eigen::Matrix2Xd& bounds,
                                           const Eigen::VectorXd& start,
                                           const Eigen::MatrixXd& goals,
                                           const TrackOptions& options) const {
  if (experience_.paths.empty() || goals.cols() == 0)
    return {};
  const Eigen::Isometry3d T_base_task = T_task_base.inverse();
  PoseQuery query{T_task_base * kinematics::T_base_transfer(chain_, start), {}};
  const auto goal_count = static_cast<std::size_t>(goals.cols());
  const std::size_t paths_per_goal =
      std::clamp<std::size_t>(options.tracks / goal_count, 1, options.paths);
  std::vector<PoseTrack> wanted;
  for (Eigen::Index goal = 0; goal < goals.cols() && wanted.size() < options.tracks; ++goal) {
    query.T_task_goal = T_task_base * kinematics::T_base_transfer(chain_, goals.col(goal));
    for (const std::size_t path : nearest_paths(experience_.paths, query, paths_per_goal)) {
      PoseTrack track{moved_onto(experience_.paths[path], query), goals.col(goal), start};
      std::ranges::reverse(track.T_base_transfer);
      for (Eigen::Isometry3d& pose : track.T_base_transfer)
        pose = T_base_task * pose;
      wanted.push_back(std::move(track));
    }
  }
  std::vector<Track> tracks = follow(solver_, wanted);
  const std::vector<bool> turning = turning_joints(chain_);
  for (Track& track : tracks)
    keep_within(bounds, turning, track);
  std::erase_if(tracks, [](const Track& track) { return track.configurations.cols() == 0; });
  std::ranges::stable_sort(tracks, {}, &Track::gap);
  return tracks;
}

}  // namespace kinship::planning
