#include "robots/planning/experience_guide.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/moved_path.hpp"
#include "robots/planning/planning_bounds.hpp"

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

std::vector<std::size_t> ExperienceGuide::nearest(const PoseQuery& query, std::size_t count,
                                                  const std::optional<Uuid>& without) const {
  if (count == 0)
    return {};
  std::vector<std::size_t> paths =
      nearest_paths(experience_.paths, query, without ? count + 1 : count);
  std::erase_if(paths, [&](std::size_t path) { return experience_.paths[path].path == without; });
  if (paths.size() > count)
    paths.pop_back();
  return paths;
}

std::vector<ExperienceGuide::Choice> ExperienceGuide::choose(const TrackQuery& query,
                                                             const TrackOptions& options) const {
  const Eigen::VectorXd distances = (query.goals.colwise() - query.start).colwise().norm();
  std::vector<Eigen::Index> goals(static_cast<std::size_t>(query.goals.cols()));
  std::iota(goals.begin(), goals.end(), Eigen::Index{0});
  std::ranges::stable_sort(goals, {}, [&](Eigen::Index goal) { return distances[goal]; });
  if (goals.size() > options.tracks)
    goals.resize(options.tracks);

  PoseQuery posed{query.T_task_base * kinematics::T_base_transfer(chain_, query.start), {}};
  std::vector<std::vector<std::size_t>> paths;
  for (const Eigen::Index goal : goals) {
    posed.T_task_goal =
        query.T_task_base * kinematics::T_base_transfer(chain_, query.goals.col(goal));
    paths.push_back(nearest(posed, options.paths, query.without));
  }
  std::vector<Choice> choices;
  for (std::size_t i = 0; i < std::min(goals.size(), options.retreats); ++i)
    choices.push_back({goals[i], std::nullopt});
  for (std::size_t rank = 0; rank < options.paths; ++rank)
    for (std::size_t i = 0; i < goals.size(); ++i)
      if (rank < paths[i].size())
        choices.push_back({goals[i], paths[i][rank]});
  choices.resize(std::min(choices.size(), options.tracks));
  return choices;
}

std::vector<Track> ExperienceGuide::follow(const TrackQuery& query, std::span<const Choice> choices,
                                           const TrackOptions& options) const {
  const PosePath without_experience = retreat(options.retreat_m);
  const Eigen::Isometry3d T_base_task = query.T_task_base.inverse();
  PoseQuery posed{query.T_task_base * kinematics::T_base_transfer(chain_, query.start), {}};
  std::vector<PoseTrack> wanted;
  for (const Choice& choice : choices) {
    const Eigen::VectorXd goal = query.goals.col(choice.goal);
    posed.T_task_goal = query.T_task_base * kinematics::T_base_transfer(chain_, goal);
    const PosePath& path = choice.path ? experience_.paths[*choice.path] : without_experience;
    PoseTrack track{moved_onto(path, posed), goal, query.start};
    std::ranges::reverse(track.T_base_transfer);
    for (Eigen::Isometry3d& pose : track.T_base_transfer)
      pose = T_base_task * pose;
    wanted.push_back(std::move(track));
  }
  std::vector<Track> tracks = planning::follow(solver_, wanted);
  const std::vector<bool> turning = turning_joints(chain_);
  for (Track& track : tracks)
    keep_within(query.bounds, turning, track);
  std::erase_if(tracks, [](const Track& track) { return track.configurations.cols() == 0; });
  std::ranges::stable_sort(tracks, {}, &Track::gap);
  return tracks;
}

}  // namespace kinship::planning
