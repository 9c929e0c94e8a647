#include "robots/recall/recall.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "proto/types/number_text.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::c_library {
namespace {

static_assert(KINSHIP_RECALL_WAYPOINTS == kRecallWaypoints);

struct GivenUp {};  // leaves recall between two checks

/// Goals within the bounds of a plan; a goal that a joint's limit excludes is left out.
/// \throws Failure(InvalidInput) if none is left.
Eigen::MatrixXd read_goals(const kinship_recall_query& given, const kinematics::Chain& chain,
                           const Eigen::Matrix2Xd& bounds) {
  if (given.goal_count > KINSHIP_RECALL_GOALS)
    throw Failure(invalid_input("query->goal_count is " + std::to_string(given.goal_count) +
                                ", must be at most " + std::to_string(KINSHIP_RECALL_GOALS) +
                                " (KINSHIP_RECALL_GOALS)"));
  const Eigen::MatrixXd read =
      read_columns(given.goals, chain.dof(), given.goal_count, "query->goals");
  Eigen::MatrixXd goals = planning::all_turned_into(bounds, chain, read);
  if (goals.cols() == 0)
    throw Failure(invalid_input("query->goals: all are beyond the limits of the joints"));
  return goals;
}

recall::Query read_query(const kinship_recall_query& given, const recall::RecallGuide& guide) {
  const kinematics::Chain& chain = guide.warper().chain();
  if (given.dof != static_cast<std::size_t>(chain.dof()))
    throw Failure(invalid_input("query->dof is " + std::to_string(given.dof) + ", must be " +
                                std::to_string(chain.dof()) + ", the joints of the robot"));
  recall::Query query;
  if (given.T_task_base != nullptr)
    query.T_task_base = read_pose(given.T_task_base, "query->T_task_base");
  query.start = read_columns(given.start, chain.dof(), 1, "query->start");
  query.bounds = planning::planning_bounds(chain, query.start);
  if (planning::all_turned_into(query.bounds, chain, query.start).cols() == 0)
    throw Failure(invalid_input("query->start is beyond the limits of the joints"));
  if (given.goal_count > 0) {
    query.goals = read_goals(given, chain, query.bounds);
  } else {
    require(given.T_task_goal, "query->T_task_goal");
    query.goals.resize(chain.dof(), 0);
    query.T_base_goal =
        query.T_task_base.inverse() * read_pose(given.T_task_goal, "query->T_task_goal");
  }
  query.T_task_anchors = recall::find_anchors(
      guide.library().anchors,
      read_scene({given.objects, given.object_count, nullptr, 0}, "query").scene.objects);
  return query;
}

/// The caller's checker.
/// \param checks  out: its calls of is_free are added, also if it gives up.
planning::IsFree read_checker(const kinship_recall_query& given, std::uint64_t& checks) {
  const auto is_yes = [](int answer) {
    if (answer < 0)
      throw GivenUp();
    return answer != 0;
  };
  planning::IsFree::One one = [given, is_yes, &checks](const Eigen::VectorXd& q) {
    ++checks;
    return is_yes(given.is_free(given.user, q.data(), given.dof));
  };
  if (given.is_line_free == nullptr)
    return one;
  return {one, {}, {}, [given, is_yes](const auto& from, const auto& to) {
            planning::IsFree::Lines lines(static_cast<std::size_t>(from.cols()));
            for (Eigen::Index i = 0; i < from.cols(); ++i) {
              const Eigen::VectorXd begin = from.col(i), end = to.col(i);
              if (!is_yes(given.is_line_free(given.user, begin.data(), end.data(), given.dof)))
                break;
              lines[static_cast<std::size_t>(i)] = true;
            }
            return lines;
          }};
}

recall::RecallSummary try_paths(kinship_recall& recall, const recall::Query& query,
                                const planning::IsFree& is_free, double step) {
  recall::RecallOptions options{.step = step};
  {
    const std::scoped_lock lock(recall.mutex);
    options.trust = recall.trust.value();
  }
  recall::RecallSummary summary = recall::recall(recall.guide, query, is_free, options);
  const std::scoped_lock lock(recall.mutex);
  recall.trust.add(summary.expected, summary.waypoints && !summary.is_straight_line);
  return summary;
}

}  // namespace

Eigen::MatrixXd read_columns(const double* numbers, Eigen::Index dof, std::size_t count,
                             const std::string& name) {
  require(numbers, name.c_str());
  const Eigen::Map<const Eigen::MatrixXd> read(numbers, dof, static_cast<Eigen::Index>(count));
  if (!read.allFinite())
    throw Failure(invalid_input(name + " has a number that is not finite"));
  return read;
}

}  // namespace kinship::c_library

using namespace kinship::c_library;

void kinship_recall_free(kinship_recall* recall) { delete recall; }

kinship_code kinship_recall_path(kinship_recall* recall, const kinship_recall_query* query,
                                 double* waypoints, size_t room, kinship_recalled* recalled) {
  return guarded([&] {
    constexpr double kUsualStep = 0.05, kLeastStep = 1e-4, kLargestStep = 1;
    require(recall, "recall");
    require(waypoints, "waypoints");
    require(recalled, "recalled");
    const kinship_recall_query given = read_structure(query, "query");
    require(reinterpret_cast<const void*>(given.is_free), "query->is_free");  // NOLINT: a function
    if (room < KINSHIP_RECALL_WAYPOINTS)
      throw kinship::Failure(
          kinship::invalid_input("room is " + std::to_string(room) + ", must be at least " +
                                 std::to_string(KINSHIP_RECALL_WAYPOINTS) + " configurations"));
    const double step = given.step == 0 ? kUsualStep : given.step;
    if (!(step >= kLeastStep && step <= kLargestStep))
      throw kinship::Failure(kinship::invalid_input(
          "query->step is " + kinship::number_text(step) + ", must be from " +
          kinship::number_text(kLeastStep) + " to " + kinship::number_text(kLargestStep)));
    kinship_recalled told{};
    try {
      const kinship::recall::RecallSummary summary = try_paths(
          *recall, read_query(given, recall->guide), read_checker(given, told.checks), step);
      told.tries = summary.tries;
      if (summary.waypoints) {
        const Eigen::MatrixXd path = kinship::planning::sparse_vertices(*summary.waypoints, step);
        told.is_recalled = 1;
        told.is_straight_line = summary.is_straight_line ? 1 : 0;
        told.waypoint_count = static_cast<size_t>(path.cols());
        std::copy_n(path.data(), path.size(), waypoints);
      }
    } catch (const GivenUp&) {  // nothing is recalled
    }
    write_structure(told, recalled, "recalled");
    return KINSHIP_OK;
  });
}
