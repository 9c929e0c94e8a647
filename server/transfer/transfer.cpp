#include "server/transfer/transfer.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/transfer/path_poses.hpp"
#include "server/transfer/random_solutions.hpp"
#include "server/transfer/resample.hpp"
#include "server/transfer/shape_tracker.hpp"
#include "server/transfer/take_over.hpp"

namespace kinship::transfer {
namespace {

/// \throws std::invalid_argument with the parameter that breaks a rule. Those of resampling and
///         inverse kinematics are checked there.
void check(const TransferParameters& parameters) {
  const auto require = [](bool holds, const char* name, double value, const char* rule) {
    if (!holds)
      throw std::invalid_argument(std::string("transfer_path: ") + name + " " +
                                  std::to_string(value) + " is not " + rule);
  };
  const double coverage = parameters.least_coverage;
  require(parameters.tracks >= 0, "tracks", parameters.tracks, "0 or more");
  require(parameters.track_candidates >= 1, "track_candidates", parameters.track_candidates,
          "1 or more");
  require(coverage >= 0 && coverage <= 1, "least_coverage", coverage, "within 0 and 1");
  require(parameters.shape_noise >= 0, "shape_noise", parameters.shape_noise, "0 or more");
  require(parameters.shape_steps >= 0, "shape_steps", parameters.shape_steps, "0 or more");
}

/// Configurations of the target for each pose of one path, as they are found.
class PathSolutions {
 public:
  PathSolutions(Eigen::Index dof, Eigen::Index poses)
      : dof_(dof), of_pose_(static_cast<std::size_t>(poses), Eigen::MatrixXd(dof, 0)) {}

  void add(const Track& track) {
    for (Eigen::Index i = 0; i < track.configurations.cols(); ++i) {
      Eigen::MatrixXd& solutions = of_pose_[static_cast<std::size_t>(track.first_pose + i)];
      solutions.conservativeResize(Eigen::NoChange, solutions.cols() + 1);
      solutions.rightCols(1) = track.configurations.col(i);
    }
  }

  Eigen::MatrixXd& operator[](std::size_t pose) { return of_pose_[pose]; }

  /// One row per solution, in the order of poses.
  TransferredPath stacked(const TransferSummary& summary) const;

 private:
  Eigen::Index dof_;
  std::vector<Eigen::MatrixXd> of_pose_;
};

TransferredPath PathSolutions::stacked(const TransferSummary& summary) const {
  const auto total = static_cast<Eigen::Index>(summary.configurations);
  TransferredPath result;
  result.configurations.resize(dof_, total);
  result.pose_index.resize(total);
  result.solution_index.resize(total);
  result.weights = Eigen::VectorXd::Ones(total);
  result.summary = summary;
  Eigen::Index next = 0;
  for (std::size_t pose = 0; pose < of_pose_.size(); ++pose)
    for (Eigen::Index i = 0; i < of_pose_[pose].cols(); ++i, ++next) {
      result.configurations.col(next) = of_pose_[pose].col(i);
      result.pose_index[next] = static_cast<int>(pose);
      result.solution_index[next] = static_cast<int>(i);
    }
  return result;
}

}  // namespace

TransferredPath transfer_path(const Path& path, const ArmPair& pair,
                              const Eigen::Isometry3d& T_target_source,
                              const TransferParameters& parameters, std::uint64_t seed,
                              const Filters& filters) {
  check(parameters);
  if (path.dof() != pair.source().dof())
    throw std::invalid_argument("transfer_path: a path of " + std::to_string(path.dof()) +
                                " joints for a source robot of " +
                                std::to_string(pair.source().dof()));
  const Eigen::MatrixXd waypoints = resample(path, parameters);
  if (parameters.take_over && pair.takes_over(T_target_source))
    return take_over(waypoints, pair);

  const PathPoses poses = path_poses(waypoints, pair, T_target_source);
  CountedFilters counted(filters);
  ShapeTracker tracker(pair, poses, parameters, seed, counted);
  PathSolutions solutions(pair.target().dof(), poses.size());
  TransferSummary summary;
  for (const Track& track : tracker.find_tracks()) {
    solutions.add(track);
    ++summary.tracks_kept;
  }
  summary.tracks_tried = tracker.tried();
  summary.tracks_through = tracker.came_through();
  for (std::size_t pose = 0; pose < poses.T_base_transfer.size(); ++pose) {
    if (solutions[pose].cols() > 0) {
      summary.count(solutions[pose].cols(), inverse::NoSolution::None);
      continue;
    }
    RandomSolutions random = random_solutions(pair.target_solver(), poses.T_base_transfer[pose],
                                              parameters, seed, counted);
    summary.count(random);
    solutions[pose] = std::move(random.configurations);
  }
  summary.set(counted);
  return solutions.stacked(summary);
}

}  // namespace kinship::transfer
