#include "server/transfer/transfer.hpp"

#include <algorithm>
#include <cstddef>
#include <list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robots/kinematics/resample.hpp"
#include "server/transfer/extension_pool.hpp"
#include "server/transfer/path_poses.hpp"
#include "server/transfer/shape_tracker.hpp"
#include "server/transfer/take_over.hpp"
#include "server/transfer/uncovered_poses.hpp"

namespace kinship::transfer {
namespace {

/// \throws std::invalid_argument with the parameter that breaks a rule. Parameters of resampling
///         and inverse kinematics are checked there.
void check_tracking(const TransferParameters& parameters) {
  const auto require = [](bool holds, const char* name, double value, const char* rule) {
    if (!holds)
      throw std::invalid_argument(std::string("transfer: ") + name + " " + std::to_string(value) +
                                  " is not " + rule);
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

  void add(const std::vector<Track>& tracks) {
    std::vector<Eigen::Index> left(of_pose_.size(), 0);
    const auto at = [](const Track& track, Eigen::Index i) {
      return static_cast<std::size_t>(track.first_pose + i);
    };
    for (const Track& track : tracks)
      for (Eigen::Index i = 0; i < track.configurations.cols(); ++i)
        ++left[at(track, i)];
    for (std::size_t pose = 0; pose < of_pose_.size(); ++pose)
      of_pose_[pose].resize(dof_, left[pose]);
    for (const Track& track : tracks)
      for (Eigen::Index i = 0; i < track.configurations.cols(); ++i) {
        Eigen::MatrixXd& solutions = of_pose_[at(track, i)];
        solutions.col(solutions.cols() - left[at(track, i)]--) = track.configurations.col(i);
      }
  }

  Eigen::MatrixXd& operator[](std::size_t pose) { return of_pose_[pose]; }

  /// Of each pose whether there is any.
  std::vector<bool> covered() const {
    std::vector<bool> result;
    for (const Eigen::MatrixXd& solutions : of_pose_)
      result.push_back(solutions.cols() > 0);
    return result;
  }

  /// One row per solution, in the order of poses.
  TransferredPath stacked(const TransferCounts& summary) const;

 private:
  Eigen::Index dof_;
  std::vector<Eigen::MatrixXd> of_pose_;
};

TransferredPath PathSolutions::stacked(const TransferCounts& summary) const {
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

/// A path on its way through inverse kinematics.
struct PathUnderWay {
  PathUnderWay(const PathToTransfer& the_path, const Eigen::MatrixXd& waypoints,
               const ArmPair& pair, const TransferParameters& parameters, std::uint64_t seed)
      : path(the_path),
        poses(path_poses(waypoints, pair, path.T_target_source)),
        counted(path.filters),
        tracker(pair, poses, parameters, seed, counted) {}

  const PathToTransfer& path;
  const PathPoses poses;
  CountedFilters counted;
  ShapeTracker tracker;  // of the poses
};

/// Tracks, and random solutions where they are missing.
TransferredPath with_random_solutions(PathUnderWay& path, const ArmPair& pair,
                                      const TransferParameters& parameters, const Search& search) {
  PathSolutions solutions(pair.target().dof(), path.poses.size());
  TransferCounts summary;
  solutions.add(path.tracker.tracks());
  summary.tracks_kept = path.tracker.tracks().size();
  summary.tracks_tried = path.tracker.tried();
  summary.tracks_through = path.tracker.came_through();
  const std::vector<bool> covered = solutions.covered();
  std::vector<RandomSolutions> random =
      solve_uncovered(pair, path.poses, covered, parameters, search, path.counted);
  for (std::size_t pose = 0; pose < covered.size(); ++pose) {
    if (covered[pose]) {
      ++summary.poses_on_tracks;
      count_pose(solutions[pose].cols(), inverse::NoSolution::None, summary);
      continue;
    }
    count_pose(random[pose], summary);
    solutions[pose] = std::move(random[pose].configurations);
  }
  count_filtered(path.counted, summary);
  return solutions.stacked(summary);
}

/// One stream of paths. The arguments outlive it.
class Transfer {
 public:
  Transfer(const PathStream& paths, const ArmPair& pair, const TransferParameters& parameters,
           Search search)
      : paths_(paths), pair_(pair), parameters_(parameters), search_(std::move(search)) {}

  void run() {
    ExtensionPool(pair_).run(
        {.next = [this] { return next(); }, .done = [this](ShapeTracker& t) { finish(t); }},
        search_.stop);
  }

 private:
  /// The tracker of the next path that is not taken over.
  ShapeTracker* next() {
    while (const PathToTransfer* const path = paths_.next()) {
      if (path->path.dof() != pair_.source().dof())
        throw std::invalid_argument("transfer: a path of " + std::to_string(path->path.dof()) +
                                    " joints for a source robot of " +
                                    std::to_string(pair_.source().dof()));
      const Eigen::MatrixXd waypoints = kinematics::resample(path->path, parameters_);
      if (parameters_.take_over && pair_.takes_over(path->T_target_source)) {
        paths_.done(*path, take_over(waypoints, pair_));
        continue;
      }
      under_way_.emplace_back(*path, waypoints, pair_, parameters_, search_.seed);
      return &under_way_.back().tracker;
    }
    return nullptr;
  }

  void finish(const ShapeTracker& tracker) {
    const auto path = std::ranges::find_if(
        under_way_, [&](const PathUnderWay& one) { return &one.tracker == &tracker; });
    paths_.done(path->path, with_random_solutions(*path, pair_, parameters_, search_));
    under_way_.erase(path);
  }

  const PathStream& paths_;
  const ArmPair& pair_;
  const TransferParameters& parameters_;
  const Search search_;
  std::list<PathUnderWay> under_way_;  // trackers stay where they are
};

}  // namespace

void transfer_stream(const PathStream& paths, const ArmPair& pair,
                     const TransferParameters& parameters, std::uint64_t seed,
                     const std::stop_token& stop) {
  check_tracking(parameters);
  Transfer(paths, pair, parameters, {seed, stop}).run();
}

std::vector<TransferredPath> transfer_paths(std::span<const PathToTransfer> paths,
                                            const ArmPair& pair,
                                            const TransferParameters& parameters,
                                            std::uint64_t seed, const std::stop_token& stop) {
  std::vector<TransferredPath> results(paths.size());
  std::size_t next = 0;
  transfer_stream({.next = [&] { return next < paths.size() ? &paths[next++] : nullptr; },
                   .done =
                       [&](const PathToTransfer& path, TransferredPath transferred) {
                         results[static_cast<std::size_t>(&path - paths.data())] =
                             std::move(transferred);
                       }},
                  pair, parameters, seed, stop);
  return results;
}

}  // namespace kinship::transfer
