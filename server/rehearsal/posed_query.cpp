#include "server/rehearsal/posed_query.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "proto/types/split_mix.hpp"
#include "robots/collision/recorded_surroundings.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::rehearsal {
namespace {

bool is_start(const kinematics::Chain& chain, const Eigen::VectorXd& q) {
  return q.size() == chain.dof() && q.allFinite() && chain.within_limits(q);
}

/// Of the configurations with the hand at the recorded start.
/// \param drawn  chooses one; nothing: Branch::Usual
std::optional<Eigen::VectorXd> find_start(const kinematics::Chain& chain,
                                          const Eigen::Isometry3d& T_base_start,
                                          const planning::IsFree& is_free,
                                          const Eigen::VectorXd& usual,
                                          std::optional<std::uint64_t> drawn) {
  const Eigen::VectorXd near =
      is_start(chain, usual) ? usual : Eigen::VectorXd((chain.lower() + chain.upper()) / 2);
  const Eigen::MatrixXd found =
      planning::goal_configurations(chain, T_base_start, planning::planning_bounds(chain, near),
                                    is_free)
          .configurations;
  if (found.cols() == 0)
    return std::nullopt;
  Eigen::Index chosen = 0;
  if (drawn)
    chosen = static_cast<Eigen::Index>(*drawn % static_cast<std::uint64_t>(found.cols()));
  else
    (found.colwise() - near).colwise().norm().minCoeff(&chosen);
  return found.col(chosen);
}

std::uint64_t drawn_for(const Uuid& path) {
  std::uint64_t state = 0;
  for (const std::uint8_t byte : path.bytes)
    state = split_mixed(state + kSplitMixStep + byte);
  return state;
}

}  // namespace

Starts find_starts(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
                   const std::vector<RecordedQuery>& recorded, const Eigen::VectorXd& usual) {
  constexpr double kSamePlace_m = 0.02;
  constexpr std::size_t kOneIn = 4;  // starts are at places of their own, if they spread
  std::vector<Eigen::Isometry3d> places;
  std::size_t count = 0;
  const auto distance = [](const Eigen::Isometry3d& a) {
    return [&a](const Eigen::Isometry3d& b) { return planning::pose_distance_m(a, b); };
  };
  for (const RecordedQuery& query : recorded) {
    if (query.own)
      continue;
    ++count;
    if (std::ranges::none_of(places, [&](const Eigen::Isometry3d& place) {
          return distance(query.T_task_start)(place) < kSamePlace_m;
        }))
      places.push_back(query.T_task_start);
  }
  Starts starts{usual, kOneIn * places.size() >= count && places.size() > 1};
  if (!starts.are_recorded || !is_start(chain, usual))
    return starts;
  double spread = std::numeric_limits<double>::infinity();  // of the places, about the middle one
  for (const Eigen::Isometry3d& place : places) {
    std::vector<double> to_others;
    std::ranges::transform(places, std::back_inserter(to_others), distance(place));
    const auto middle = to_others.begin() + std::ssize(to_others) / 2;
    std::ranges::nth_element(to_others, middle);
    spread = std::min(spread, *middle);
  }
  const Eigen::Isometry3d T_task_usual = T_task_base * kinematics::T_base_transfer(chain, usual);
  starts.are_recorded = std::ranges::any_of(places, [&](const Eigen::Isometry3d& place) {
    return distance(T_task_usual)(place) <= spread;
  });
  return starts;
}

std::optional<PosedQuery> pose_query(const runtime::Robot& robot,
                                     const Eigen::Isometry3d& T_task_base_today,
                                     const RecordedQuery& recorded, const Starts& starts,
                                     Branch branch) {
  PosedQuery posed;
  const Eigen::Isometry3d T_task_base =
      recorded.own ? recorded.T_task_base : recorded.T_task_drawn_base.value_or(T_task_base_today);
  const collision::RobotSolids solids(robot.chain, robot.shapes);
  posed.surroundings =
      recorded.scene
          ? collision::recorded_surroundings(solids, *recorded.scene, T_task_base).surroundings
          : collision::Surroundings{T_task_base, {}, {}, {}};
  posed.world = std::make_unique<collision::CollisionWorld>(solids, posed.surroundings);
  const Eigen::Isometry3d T_base_task = T_task_base.inverse();
  const std::optional<TaskSpaceRegion> region =
      recorded.scene ? recorded.scene->constraint : std::nullopt;
  const planning::IsFree is_free = planning::free_in(*posed.world);
  const std::optional<Eigen::VectorXd> start =
      recorded.own ? std::optional<Eigen::VectorXd>(recorded.own->col(0))
      : !starts.are_recorded && is_start(robot.chain, starts.usual) && is_free(starts.usual)
          ? std::optional<Eigen::VectorXd>(starts.usual)
          : find_start(robot.chain, T_base_task * recorded.T_task_start, is_free, starts.usual,
                       starts.are_recorded && branch == Branch::Drawn
                           ? std::optional(drawn_for(recorded.path))
                           : std::nullopt);
  if (!start || !is_free(*start))
    return std::nullopt;
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, *start);
  if (region)
    posed.constraint.emplace(robot.chain, *region, T_task_base, bounds);
  planning::GoalConfigurations goals = planning::goal_configurations(
      robot.chain, T_base_task * recorded.T_task_goal, bounds, is_free);
  if (goals.configurations.cols() == 0)
    return std::nullopt;
  posed.query = {T_task_base, bounds, *start, std::move(goals.configurations), recorded.path};
  return posed;
}

}  // namespace kinship::rehearsal
