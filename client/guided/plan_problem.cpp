#include "client/guided/plan_problem.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "client/guided/contact_notes.hpp"
#include "client/guided/problem_mismatch.hpp"
#include "client/guided/query_outcome.hpp"
#include "client/guided/search_notes.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/inverse/unreached.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/planning/proven_path.hpp"
#include "robots/planning/region_constraint.hpp"
#include "robots/planning/repetition_roadmap.hpp"
#include "robots/planning/rrt_connect.hpp"
#include "robots/planning/shortcut.hpp"
#include "robots/recall/recall.hpp"

namespace kinship::guided {
namespace {

using planning::NoPath;

struct Interrupted {};  // leaves a planner between two checks

/// The configurations where planning may go: within limits to rounding, turning joints in the
/// turn of the start.
Eigen::MatrixXd within_bounds(const kinematics::Chain& chain, const Eigen::Matrix2Xd& bounds,
                              const Eigen::MatrixXd& configurations) {
  Eigen::MatrixXd limited = configurations;
  for (Eigen::Index i = 0; i < limited.rows(); ++i)
    if (chain.joints()[static_cast<std::size_t>(i)].type != kinematics::JointType::Continuous)
      limited.row(i) = limited.row(i).cwiseMax(chain.lower()[i]).cwiseMin(chain.upper()[i]);
  return planning::all_turned_into(bounds, chain, limited);
}

/// "roll by 0.2, z by -0.1": the excess over a region, m and rad.
std::string described(const planning::RegionConstraint::Vector6& excess) {
  std::string text;
  for (Eigen::Index i = 0; i < excess.size(); ++i)
    if (excess[i] != 0)
      text += (text.empty() ? "" : ", ") + std::string(displacement_name(i)) + " by " +
              std::to_string(excess[i]);
  return text + " outside Bw";
}

/// "every goal collides: 'l4' touches 'wall'", or the text alone where nothing more is known.
std::string with_detail(const std::string& text, const std::string& detail) {
  return detail.empty() ? text : text + ": " + detail;
}

/// One problem under way.
class Planning {
 public:
  Planning(const PlannedRobot& robot, const Problem& problem, const PlanSettings& settings,
           const std::function<bool()>& stop, planning::SearchRecorder* recorder)
      : robot_(robot),
        problem_(problem),
        settings_(settings),
        T_task_base_(problem.T_task_base.value_or(Eigen::Isometry3d::Identity())),
        world_(robot.solids,
               {T_task_base_, problem.scene, problem.attached, problem.allowed_collisions}),
        prover_(world_),
        goal_contacts_(find_near()),
        notes_(settings.record_search, robot.chain.dof()),
        asked_(what_is_free(stop)),
        is_free_(notes_.is_wanted() ? notes_.watched(asked_) : asked_),
        recorder_(recorder),
        generator_(problem.seed) {}

  void run(const PlannerChoice& planner, const QueryGuidance& query, PlannedProblem& planned) {
    const double begin_s = planning::thread_time_s();
    plan(planner, query, planned);
    planned.result.processor_time_s = planning::thread_time_s() - begin_s;
    if (const ProblemResult& result = planned.result;
        notes_.has_record(result.solved, result.processor_time_s, settings_.slow_time_s))
      planned.search = notes_.record(problem_, start_, asked_goals_, result.reason, find_near());
  }

 private:
  void plan(const PlannerChoice& planner, const QueryGuidance& query, PlannedProblem& planned) {
    if (!find_start(planned.result))
      return;
    planned.enclosed = world_.find_enclosed(start_);
    bounds_ = planning::planning_bounds(robot_.chain, start_);
    if (problem_.constraint)
      constraint_.emplace(robot_.chain, *problem_.constraint, T_task_base_, bounds_);
    Eigen::MatrixXd goals;
    if (!problem_.T_task_goal && (goals = find_goals(planned.result)).cols() == 0)
      return;
    if (query.guidance != nullptr && recall(query, goals, planned))
      return;
    if (problem_.T_task_goal && (goals = find_goals(planned.result)).cols() == 0)
      return;
    planning::BirrtOptions options;
    options.step = settings_.resolution;
    options.overshoot = settings_.overshoot;
    options.max_checks =
        settings_.max_checks - std::min(planned.result.collision_checks, settings_.max_checks);
    options.time_limit = std::chrono::duration<double>(problem_.time_limit_s);
    end_ = std::chrono::steady_clock::now() + options.time_limit;
    options.track_check_fraction = settings_.tracks.check_fraction;
    options.recorder = recorder_;
    options.trees = notes_.trees();
    const double begin_s = planning::thread_time_s();
    const auto sampler = make_query_sampler(
        robot_.chain,
        {T_task_base_, bounds_, start_, goals, {}, [this] { return recall::whole(failed_); }},
        query.guidance, settings_, planned.result);
    planned.result.planner = planner_text(planner, sampler);
    planned.result.not_planned.reset();
    planning::PlanSummary summary = search(planner, start_, goals, sampler, options);
    if (summary.waypoints)
      shorten(sampler, options, summary, planned.result);
    planned.outcome = outcome_of(summary);
    planned.result.not_planned = not_planned_by(summary.reason);
    planned.result.solved = summary.waypoints.has_value();
    planned.result.collision_checks += summary.collision_checks;
    planned.result.projections += summary.projections;
    planned.result.planning_time_s += planning::thread_time_s() - begin_s - shortening_s_;
    planned.result.tracks_followed = summary.tracks_followed;
    planned.result.found_by = summary.found_by;
    planned.result.reason = explain(summary.reason, summary.planner_message);
  }

  /// Tries whole stored paths, which needs no goal configurations of a pose.
  /// \return whether one solves the problem.
  bool recall(const QueryGuidance& from, const Eigen::MatrixXd& goals, PlannedProblem& planned) {
    const Guidance& guidance = *from.guidance;
    ProblemResult& result = planned.result;
    if (!guidance.recall || !has_recall(guidance.guide) ||
        result.sampling_mode != SamplingMode::Guided)
      return false;
    const double begin_s = planning::thread_time_s();
    recall::Query query{T_task_base_, bounds_, start_, goals};
    if (problem_.T_task_goal)
      query.T_base_goal = T_task_base_.inverse() * *problem_.T_task_goal;
    query.T_task_anchors =
        recall::find_anchors(guidance.recall->library().anchors, problem_.scene.objects);
    query.constraint = constraint_or_null();
    recall::RecallOptions options{.step = settings_.resolution, .max_checks = settings_.max_checks};
    options.trust = from.recall_trust;
    recall::RecallSummary summary = recall::recall(*guidance.recall, query, is_free_, options);
    planned.recall_expected = summary.expected;
    result.guide = guidance.guide;
    result.collision_checks = summary.collision_checks;
    result.recall_tries = summary.tries;
    result.projections = constraint_ ? constraint_->projections() : 0;
    result.planning_time_s = planning::thread_time_s() - begin_s;
    failed_ = std::move(summary.failed);
    if (!summary.waypoints)
      return false;
    result.solved = true;
    result.not_planned.reset();
    result.found_by = summary.is_straight_line ? FoundBy::StraightLine : FoundBy::Recalled;
    result.proven = is_free_.proves_edges();
    result.waypoints = vertices(*summary.waypoints, settings_.resolution);
    planned.outcome = Outcome::Solved;
    if (recorder_ != nullptr)
      planning::record_path(*recorder_, is_free_, *summary.waypoints);
    return true;
  }

  planning::IsFree what_is_free(const std::function<bool()>& stop) {
    const auto interrupt = [&stop] {
      if (stop())
        throw Interrupted();
    };
    if (settings_.clearance_m == 0)
      return planning::free_in(world_, interrupt);
    return planning::proven_in(prover_, {settings_.clearance_m}, interrupt);
  }

  planning::PlanSummary search(const PlannerChoice& planner, const Eigen::VectorXd& start,
                               const Eigen::MatrixXd& goals,
                               const planning::ConfigurationSampler& sampler,
                               const planning::BirrtOptions& options) {
    if (planner.kind == PlannerKind::Roadmap) {
      planning::RoadmapOptions roadmap;
      roadmap.tree = options;
      return constraint_
                 ? planning::plan_roadmap(start, goals, {is_free_, *constraint_}, sampler, roadmap,
                                          generator_)
                 : planning::plan_roadmap(start, goals, is_free_, sampler, roadmap, generator_);
    }
    if (planner.kind == PlannerKind::RrtConnect)
      return planning::plan_rrt_connect(start, goals, is_free_, sampler, options, generator_);
    const planning::Freedom freedom{is_free_, constraint_or_null()};
    if (planner.kind == PlannerKind::Other)
      return planner.other(start, goals, freedom, sampler, options, generator_);
    return planning::plan_trees(start, goals, freedom, sampler, options, generator_);
  }

  planning::RegionConstraint* constraint_or_null() { return constraint_ ? &*constraint_ : nullptr; }

  /// \return whether there is one; the result says which, or why not.
  bool find_start(ProblemResult& result) {
    if (!problem_.T_task_start) {
      start_ = problem_.start;
      result.start = start_;
      return true;
    }
    ContactNotes contacts(find_near());
    const planning::IsFree watched = contacts.watched(is_free_);
    planning::StartConfiguration found = planning::start_configuration(
        robot_.chain, robot_.solver, T_task_base_.inverse() * *problem_.T_task_start,
        problem_.goal_configurations, watched);
    result.goal_checks = found.collision_checks;
    if (!found.q) {
      result.not_planned = not_planned_by(found.reason);
      result.reason =
          found.reason == NoPath::StartCollides
              ? with_detail("every configuration of the start collides", contacts.text())
              : explain(found.reason);
      return false;
    }
    start_ = *std::move(found.q);
    result.start = start_;
    return true;
  }

  /// All of them count: the nearest may lie behind an obstacle.
  Eigen::MatrixXd find_goals(ProblemResult& result) {
    if (!problem_.T_task_goal) {
      Eigen::MatrixXd goals = within_bounds(robot_.chain, bounds_, problem_.goal_configurations);
      if (goals.cols() == 0)
        refuse(NoPath::GoalOutsideBounds, result);
      for (const auto& goal : goals.colwise())  // as none of them may be free
        goal_contacts_.note(goal);
      asked_goals_ = goals.cols() > 0 ? goals : problem_.goal_configurations;
      return goals;
    }
    const planning::IsFree watched = goal_contacts_.watched(is_free_);
    planning::GoalOptions options;
    options.max_configurations = settings_.max_goals;
    options.seed = problem_.seed;
    planning::GoalConfigurations goals = planning::goal_configurations(
        robot_.chain, robot_.solver, T_task_base_.inverse() * *problem_.T_task_goal, bounds_,
        watched, options);
    result.goal_checks += goals.collision_checks;
    asked_goals_ = goals.configurations.cols() > 0 ? goals.configurations : goal_contacts_.noted();
    if (goals.reason != NoPath::None)
      refuse(goals.reason, result);
    return std::move(goals.configurations);
  }

  void refuse(NoPath reason, ProblemResult& result) {
    result.reason = explain(reason);
    result.not_planned = not_planned_by(reason);
  }

  /// Shortens and proves the path of the search. Where it is refuted it is searched again.
  void shorten(const planning::ConfigurationSampler& sampler, planning::BirrtOptions tree,
               planning::PlanSummary& summary, ProblemResult& result) {
    const double step = settings_.resolution;
    const planning::ShortcutOptions options{step, settings_.shortcut_checks};
    const auto shorten = [&](const Eigen::MatrixXd& waypoints, const planning::IsFree& is_free) {
      const double begin_s = planning::thread_time_s();
      std::mt19937_64 generator = generator_;  // each time alike
      planning::ShortcutSummary shortened =
          planning::shortcut(waypoints, is_free, constraint_or_null(), options, generator);
      shortening_s_ += planning::thread_time_s() - begin_s;
      return shortened;
    };
    tree.track_check_fraction = 0;
    tree.recorder = nullptr;
    tree.trees = nullptr;
    std::uint64_t spent = summary.collision_checks;
    const auto plan = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to, double finer) {
      planning::PlanSummary over;
      if (!constraint_)
        over.waypoints =
            planning::detour(from, to, is_free_, bounds_, generator_, over.collision_checks);
      spent += over.collision_checks;
      if (over.waypoints)
        return over;
      tree.step = finer;
      tree.max_checks = settings_.max_checks - std::min(spent, settings_.max_checks);
      tree.time_limit = end_ - std::chrono::steady_clock::now();
      planning::PlanSummary between = search({}, from, to, sampler, tree);
      spent += between.collision_checks;
      between.collision_checks += over.collision_checks;
      if (between.waypoints)
        between.waypoints = vertices(*between.waypoints, finer);
      return between;
    };
    planning::ProvenPath proven = planning::shorten_and_prove(vertices(*summary.waypoints, step),
                                                              step, is_free_, shorten, plan);
    summary.collision_checks += proven.collision_checks;
    summary.projections += proven.projections;
    summary.reason = proven.reason;
    result.shortcut_checks = proven.shortcut_checks;
    result.refuted_edges = proven.refuted_edges;
    if (proven.reason != NoPath::None) {
      summary.waypoints.reset();
      return;
    }
    result.waypoints = std::move(proven.waypoints);
    result.proven = is_free_.proves_edges();
  }

  Eigen::MatrixXd vertices(const Eigen::MatrixXd& waypoints, double step) const {
    return constraint_ ? waypoints : planning::sparse_vertices(waypoints, step);
  }

  /// Why there is no path, with details that only this problem knows.
  std::string explain(NoPath reason, const std::string& planner_message = {}) {
    const std::string text(describe(reason));
    switch (reason) {
      case NoPath::StartCollides:
        return with_detail(text, contact_text(start_));
      case NoPath::GoalsCollide:
        return with_detail(text, goal_contacts_.text());
      case NoPath::StartOutOfReach:
      case NoPath::StartBeyondLimits:
      case NoPath::StartNotFound:
        return with_detail(text, unreached_text(*problem_.T_task_start));
      case NoPath::GoalOutOfReach:
      case NoPath::GoalBeyondLimits:
      case NoPath::GoalNotFound:
        return with_detail(text, unreached_text(*problem_.T_task_goal));
      case NoPath::StartOffConstraint:
        return text + ": " + described(constraint_->excess(start_));
      case NoPath::MaxChecks:
        return "not solved within " + std::to_string(settings_.max_checks) + " collision checks";
      case NoPath::TimeLimit:
        return "not solved within " + std::to_string(problem_.time_limit_s) + " s";
      case NoPath::GaveUp:
        return planner_message;
      default:
        return text;
    }
  }

  /// Why the robot has no configuration for a pose.
  std::string unreached_text(const Eigen::Isometry3d& T_task_wanted) const {
    const kinematics::Chain& chain = robot_.chain;
    const Eigen::Isometry3d T_base_tip =
        T_task_base_.inverse() * T_task_wanted * chain.T_tip_transfer().inverse(Eigen::Isometry);
    const std::string why = describe(inverse::find_unreached(chain, T_base_tip), chain);
    const std::string far =
        geometry::describe_far_place(chain, (T_base_tip * chain.T_tip_transfer()).translation());
    return why.empty() || far.empty() ? why + far : why + "; " + far;
  }

  FindNear find_near() {
    if (settings_.clearance_m > 0)
      return [this](const Eigen::VectorXd& q) {
        return prover_.find_near(q, {settings_.clearance_m});
      };
    return [this](const Eigen::VectorXd& q) {
      std::vector<collision::NearPair> touching;
      for (const auto& [first, second] : world_.find_contacts(q))
        touching.push_back({first, second});
      return touching;
    };
  }

  /// The contact at a configuration, or the nearest of the pairs too near.
  std::string contact_text(const Eigen::VectorXd& q) {
    const std::vector<collision::NearPair> near = find_near()(q);
    const auto nearest = std::ranges::min_element(near, {}, &collision::NearPair::clearance_m);
    return nearest == near.end() ? "" : near_text(*nearest);
  }

  const PlannedRobot& robot_;
  const Problem& problem_;
  const PlanSettings& settings_;
  const Eigen::Isometry3d T_task_base_;
  collision::CollisionWorld world_;
  collision::EdgeProver prover_;
  ContactNotes goal_contacts_;
  SearchNotes notes_;
  planning::IsFree asked_, is_free_;  // the check itself, and the one that notes what it refuses
  Eigen::MatrixXd asked_goals_;       // dof x n, also those that touch something
  Eigen::VectorXd start_;             // dof; from find_start on
  Eigen::Matrix2Xd bounds_;           // around it
  std::optional<planning::RegionConstraint> constraint_;
  std::vector<recall::Warp> failed_;  // recalled paths; they borrow the guidance
  planning::SearchRecorder* recorder_;
  std::mt19937_64 generator_;
  double shortening_s_ = 0;
  std::chrono::time_point<std::chrono::steady_clock, std::chrono::duration<double>> end_;
};

}  // namespace

PlannedProblem plan_problem(const PlannedRobot& robot, const Problem& given,
                            const QueryGuidance& query, const PlanSettings& settings,
                            const std::function<bool()>& stop, planning::SearchRecorder* recorder) {
  const WithinLimits within(robot.chain, given, settings.limit_slack);
  const Problem& problem = within.problem();
  PlannedProblem planned;
  planned.moved = within.said();
  planned.result.name = problem.name;
  planned.result.time_limit_s = problem.time_limit_s;
  if (query.guidance != nullptr) {
    planned.result.distribution_id = query.guidance->distribution_id;
    planned.result.distribution_revision = query.guidance->revision;
    planned.result.sampling_mode = query.sampling_mode;
  }
  planned.result.guidance_reason = why_unguided(query);
  const Result<PlannerChoice> planner =
      planner_for(settings.planner, problem.constraint.has_value());
  std::optional<Mismatch> mismatch =
      planner ? find_mismatch(robot.chain, problem)
              : Mismatch{NotPlanned::UnfitPlanner, planner.error().message};
  if (!mismatch && query.guidance != nullptr && query.guidance->T_task_base)
    mismatch = find_other_placement(problem, *query.guidance->T_task_base);
  if (mismatch) {
    planned.result.not_planned = mismatch->kind;
    planned.result.reason = mismatch->text;
    return planned;
  }
  planned.result.not_planned = NotPlanned::Error;  // until it gets further
  try {
    Planning planning(robot, problem, settings, stop, recorder);
    planned.attempted = true;
    planned.planner = name_of(*planner);
    planned.result.planner = planned.planner;
    planning.run(*planner, query, planned);
  } catch (const Interrupted&) {
    planned.interrupted = true;
  } catch (const std::exception& exception) {  // of one problem: the others are planned
    planned.result.reason = exception.what();
  }
  return planned;
}

}  // namespace kinship::guided
