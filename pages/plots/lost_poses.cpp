#include "pages/plots/lost_poses.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "pages/page/json_text.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/profile_text.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/recorded_surroundings.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"

namespace kinship::plots {
namespace {

using collision::CollisionWorld;

Loss loss_of(inverse::NoSolution reason) {
  switch (reason) {
    case inverse::NoSolution::OutOfReach:
      return Loss::OutOfReach;
    case inverse::NoSolution::Limits:
      return Loss::OutsideLimits;
    default:
      return Loss::NotConverged;
  }
}

/// The target at its placement: searches poses.
class Target {
 public:
  Target(const Distribution& distribution, const TransferParameters& parameters,
         const DrawnRobot& robot)
      : parameters_(parameters),
        T_task_base_(distribution.T_task_base.value_or(Eigen::Isometry3d::Identity())),
        solver_(robot.robot.chain),
        solids_(robot.robot.chain, robot.robot.shapes) {}

  const TransferParameters& parameters() const noexcept { return parameters_; }

  bool stands_at(const Eigen::Isometry3d& T_task_base) const {
    return snapped(T_task_base).matrix() == T_task_base_.matrix();
  }

  /// \param scene  of the path. \return nothing for a pose with a configuration that is kept.
  std::optional<Loss> search(const Eigen::Isometry3d& T_task_transfer,
                             const std::optional<RecordedScene>& scene) {
    const inverse::InverseSolutions found = solver_.solve(
        T_task_base_.inverse(Eigen::Isometry) * T_task_transfer *
            solver_.T_tip_transfer().inverse(Eigen::Isometry),
        {.max_solutions = parameters_.max_solutions, .min_distance = parameters_.min_distance});
    if (found.configurations.cols() == 0)
      return loss_of(found.reason);
    CollisionWorld* const world = world_of(scene);
    if (world != nullptr &&
        world->colliding_ahead(found.configurations) == found.configurations.cols())
      return Loss::Colliding;
    return std::nullopt;
  }

 private:
  /// Null if nothing is to be avoided, or nothing is known of the robot's shapes.
  CollisionWorld* world_of(const std::optional<RecordedScene>& scene) {
    if (solids_.parts().bodies.empty())
      return nullptr;
    const bool in_scene = scene && parameters_.avoid_recorded_scene;
    if (!in_scene && !parameters_.avoid_self_collision)
      return nullptr;
    const auto [known, is_new] = worlds_.try_emplace(in_scene ? content_digest(*scene) : Digest{});
    if (is_new) {
      const RecordedScene recorded = in_scene ? *scene : RecordedScene{};
      auto surroundings =
          collision::recorded_surroundings(solids_, recorded, T_task_base_).surroundings;
      surroundings.checks_links = parameters_.avoid_self_collision;
      known->second.emplace(solids_, surroundings);
    }
    return &*known->second;
  }

  const TransferParameters parameters_;
  const Eigen::Isometry3d T_task_base_;
  const inverse::Solver solver_;
  const collision::RobotSolids solids_;
  std::map<Digest, std::optional<CollisionWorld>> worlds_;  // by scene
};

/// Searches the poses of one source's paths.
class SourceSearch {
 public:
  SourceSearch(const Source& source, Target& target, LostPoses& lost)
      : source_(source), target_(target), lost_(lost) {
    summary_.label = source.label;
  }

  /// \param max_poses  of all its paths: the last path may be searched in part.
  void add(const Attempt& attempt, const kinematics::Chain& chain, std::size_t max_poses) {
    const auto T_task_base = attempt.T_task_base.value_or(Eigen::Isometry3d::Identity());
    if (source_.relation != Relation::Other && target_.parameters().take_over &&
        target_.stands_at(T_task_base)) {
      ++summary_.taken_over;
      return;
    }
    ++summary_.paths;
    const Eigen::MatrixXd qs = kinematics::resample(*attempt.path, target_.parameters());
    for (Eigen::Index i = 0; i < qs.cols() && summary_.poses < max_poses; ++i) {
      const Eigen::Isometry3d T_task_transfer =
          T_task_base * kinematics::T_base_transfer(chain, qs.col(i));
      ++summary_.poses;
      if (const auto why = target_.search(T_task_transfer, attempt.scene))
        keep(T_task_transfer.translation(), *why);
    }
  }

  const SearchedSource& summary() const noexcept { return summary_; }

 private:
  void keep(const Eigen::Vector3d& place, Loss why) {
    const auto index = static_cast<std::size_t>(why);
    ++summary_.lost.at(index);
    Eigen::Matrix3Xd& places = lost_.places.at(index);
    places.conservativeResize(Eigen::NoChange, places.cols() + 1);
    places.rightCols<1>() = place;
  }

  const Source& source_;
  Target& target_;
  LostPoses& lost_;
  SearchedSource summary_;
};

/// \param sources  that share the bounds.
void search_paths(const Distribution& distribution, const DrawnRobot& robot, std::size_t sources,
                  const LookUp& look_up, SourceSearch& search) {
  const std::size_t max_paths = std::max<std::size_t>(1, kMaxSearchedPaths / sources);
  const std::size_t max_poses = std::max<std::size_t>(1, kMaxSearchedPoses / sources);
  const kinematics::Chain& chain = robot.robot.chain;
  for (const PathSummary& summary :
       newest_paths(look_up, distribution.task, chain.digest(), max_paths)) {
    const SearchedSource& so_far = search.summary();
    if (so_far.paths + so_far.taken_over == max_paths || so_far.poses >= max_poses)
      return;
    if (summary.retired_ms != 0 || summary.received_ms < distribution.selection.since_ms)
      continue;
    try {
      const Attempt attempt = look_up.attempt(summary.report_uuid);
      if (attempt.path && attempt.path->dof() == chain.dof())
        search.add(attempt, chain, max_poses);
    } catch (const Failure&) {  // dropped after it was listed
    }
  }
}

}  // namespace

LostPoses lost_poses(const Distribution& distribution, const DrawnRobot& target,
                     const LookUp& look_up) {
  LostPoses lost;
  const Result<Profile> profile = profile_from_text(distribution.profile);
  if (!profile) {
    lost.problem = profile.error().message;
    return lost;
  }
  Target searched(distribution, profile->transfer, target);
  DrawnRobots robots(look_up);
  const auto used = [](const Source& source) { return source.paths_used > 0; };
  const auto sources = static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(1, std::ranges::count_if(distribution.sources, used)));
  for (const Source& source : distribution.sources) {
    SourceSearch search(source, searched, lost);
    const DrawnRobot* const robot = used(source) ? robots.find(source.robot) : nullptr;
    if (robot != nullptr)
      search_paths(distribution, *robot, sources, look_up, search);
    lost.sources.push_back(search.summary());
  }
  return lost;
}

namespace {

std::string json_of(const SearchedSource& source) {
  return page::object(
      {{"label", page::json_string(source.label)},
       {"paths", std::to_string(source.paths)},
       {"poses", std::to_string(source.poses)},
       {"taken_over", std::to_string(source.taken_over)},
       {"lost", page::list(source.lost, [](std::uint64_t n) { return std::to_string(n); })}});
}

}  // namespace

std::string to_json(const LostPoses& lost) {
  return page::object(
      {{"sources", page::list(lost.sources, [](const auto& source) { return json_of(source); })},
       {"places",
        page::list(lost.places,
                   [](const Eigen::Matrix3Xd& places) { return page::millimetres(places); })},
       {"problem", page::json_string(lost.problem)}});
}

}  // namespace kinship::plots
