#include "client/experiments/peer.hpp"

#include <iomanip>
#include <istream>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <random>
#include <sstream>

#include "client/ompl/ompl_experience.hpp"
#include "client/ompl/ompl_planner.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::experiments {
namespace {

using Json = nlohmann::json;
using ompl_planners::ExperienceKind;

/// A problem of a robot with what answers its collision questions.
struct Scenery {
  Scenery(const StudyMember& member, Problem drawn)
      : problem(std::move(drawn)),
        world(member.robot.chain, member.robot.shapes,
              {problem.T_task_base.value(), problem.scene, problem.attached,
               problem.allowed_collisions}) {}

  planning::IsFree is_free() {
    return [this](const Eigen::VectorXd& q) { return !world.collides(q); };
  }

  Problem problem;
  collision::CollisionWorld world;
};

Json half_of(const planning::PlanSummary& summary) {
  return {{"solved", summary.waypoints.has_value()},
          {"checks", summary.collision_checks},
          {"cpu_s", summary.planning_time_s},
          {"length", summary.waypoints ? planning::path_length(*summary.waypoints) : 0}};
}

Eigen::MatrixXd columns_of(const std::vector<std::vector<double>>& rows, Eigen::Index dof) {
  Eigen::MatrixXd columns(dof, static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (static_cast<Eigen::Index>(rows[i].size()) != dof)
      throw Failure(ErrorCode::InvalidInput, "a waypoint has another number of joints");
    columns.col(static_cast<Eigen::Index>(i)) = Eigen::VectorXd::Map(rows[i].data(), dof);
  }
  return columns;
}

class PeerRun {
 public:
  PeerRun(const Study& study, const StudyMember& member, const std::string& kind)
      : study_(study), member_(member) {
    const std::size_t colon = std::min(kind.find(':'), kind.size());
    const std::string name = kind.substr(0, colon);
    if (name != "lightning" && name != "thunder")
      throw Failure(ErrorCode::InvalidInput, "no peer '" + kind + "'");
    kind_ = name == "thunder" ? ExperienceKind::Thunder : ExperienceKind::Lightning;
    if (colon < kind.size())
      range_ = std::stod(kind.substr(colon + 1));
  }

  /// \return for people: what became of the learning set.
  std::string learn(std::istream& in) {
    std::size_t solved = 0, kept = 0;
    const double begin_s = planning::thread_time_s();
    for (std::string line; std::getline(in, line) && !line.empty();) {
      const Json lesson = Json::parse(line);
      Scenery scenery(member_,
                      json::problem_from_json(lesson.at("problem").dump()).value_or_throw());
      if (!experience_)
        experience_.emplace(kind_, bounds_of(scenery.problem), study_.settings.resolution, range_);
      ++solved;
      const Eigen::MatrixXd waypoints =
          columns_of(lesson.at("waypoints"), member_.robot.chain.dof());
      kept += experience_->learn(waypoints, scenery.is_free()) ? 1U : 0U;
    }
    if (!experience_)
      throw Failure(ErrorCode::NotFound, "no paths to learn");
    std::ostringstream learned;
    learned << kept << " of " << solved << " paths kept whole, " << experience_->size()
            << (kind_ == ExperienceKind::Lightning ? " paths, " : " vertices, ")
            << experience_->learning_checks() << " checks, " << std::fixed << std::setprecision(1)
            << planning::thread_time_s() - begin_s << " s";
    return learned.str();
  }

  Json answer(Problem asked) {
    Scenery scenery(member_, std::move(asked));
    const Problem& problem = scenery.problem;
    const planning::IsFree is_free = scenery.is_free();
    const Eigen::Matrix2Xd bounds = bounds_of(problem);
    planning::GoalOptions goal_options;
    goal_options.max_configurations = study_.settings.max_goals;
    goal_options.seed = problem.seed;
    const Eigen::MatrixXd goals =
        planning::goal_configurations(member_.robot.chain,
                                      problem.T_task_base->inverse() * problem.T_task_goal.value(),
                                      bounds, is_free, goal_options)
            .configurations;
    ompl_planners::OmplOptions ompl;
    ompl.planner = "RRTConnect";
    ompl.range = range_;
    ompl.limits.step = study_.settings.resolution;
    ompl.limits.max_checks = study_.settings.max_checks;
    ompl.limits.time_limit = std::chrono::hours(1);
    std::mt19937_64 scratch(problem.seed), recall(~problem.seed);
    const Json recalled =
        half_of(experience_->recall(problem.start, goals, is_free, ompl.limits, recall));
    return {{"recall", recalled},
            {"scratch", half_of(ompl_planners::plan_with_ompl(
                            problem.start, goals, is_free, planning::ConfigurationSampler(bounds),
                            ompl, scratch))}};
  }

 private:
  Eigen::Matrix2Xd bounds_of(const Problem& problem) const {
    return planning::planning_bounds(member_.robot.chain, problem.start);
  }

  const Study& study_;
  const StudyMember& member_;
  ExperienceKind kind_ = ExperienceKind::Lightning;
  double range_ = 0;
  std::optional<ompl_planners::OmplExperience> experience_;
};

}  // namespace

void answer_as_peer(const Study& study, const StudyMember& member, const std::string& kind,
                    std::istream& in, std::ostream& out) {
  PeerRun run(study, member, kind);
  out << Json{{"learned", run.learn(in)}}.dump() << std::endl;
  for (std::string line; std::getline(in, line);)
    out << run.answer(json::problem_from_json(line).value_or_throw()).dump() << std::endl;
}

}  // namespace kinship::experiments
