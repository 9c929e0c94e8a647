#include <pybind11/stl.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "client/guided/attempt_record.hpp"
#include "client/guided/geometry_warnings.hpp"
#include "client/guided/path_measures.hpp"
#include "client/guided/scene_record.hpp"
#include "client/ompl/planner_choice.hpp"
#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "client/python/errors.hpp"
#include "client/python/guidance_handle.hpp"
#include "client/python/waiting.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/number_text.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/geometry/geometry_doubts.hpp"

namespace kinship::python {
namespace {

using SharedGuidance = std::shared_ptr<GuidanceHandle>;
using GuidanceClass = py::class_<GuidanceHandle, SharedGuidance>;
using AnyGuidance = std::variant<SharedGuidance, std::shared_ptr<SampledDistribution>>;

/// A planned query, with its inputs.
struct Plan {
  std::shared_ptr<Robot> robot;
  Problem problem;
  guided::PlanSettings settings;
  guided::PlannedProblem planned;
};

/// A planner calls it before every check, whose time is measured: it reads the clock now and then.
/// It runs without the interpreter's lock, which is taken to let Python handle signals.
class InterruptCheck {
 public:
  bool operator()() {
    constexpr unsigned kCalls = 64;
    if (++calls_ % kCalls != 0)
      return false;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_)
      return false;
    next_ = now + kSignalInterval;
    const py::gil_scoped_acquire locked;
    return PyErr_CheckSignals() != 0;
  }

 private:
  unsigned calls_ = 0;
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + kSignalInterval;
};

SharedGuidance guidance_for(const Robot& robot, const std::optional<AnyGuidance>& given) {
  if (!given)
    return nullptr;
  const auto* distribution = std::get_if<std::shared_ptr<SampledDistribution>>(&*given);
  SharedGuidance guidance = distribution != nullptr
                                ? GuidanceHandle::of_distribution(**distribution)
                                : std::get<SharedGuidance>(*given);
  if (guidance && guidance->robot() != robot.digest())
    throw std::invalid_argument("plan: the guidance is for robot " + guidance->robot().short_hex() +
                                ", not for '" + robot.description().label + "', " +
                                robot.digest().short_hex());
  return guidance;
}

guided::QueryGuidance query_of(const SharedGuidance& guidance, const Problem& problem,
                               const std::string& sampling_mode) {
  if (!guidance)
    return {.why_not = "no guidance was given"};
  return {.guidance = &guidance->guidance(),
          .sampling_mode = sampling_mode.empty()
                               ? guidance->choose(problem)
                               : parse_word<SamplingMode>(sampling_mode).value_or_throw(),
          .recall_trust = guidance->recall_trust()};
}

/// The warnings of kinship-plan: implausible solids of the robot and of the scene.
std::vector<std::string> doubts_of(const Robot& robot, const Plan& made) {
  std::vector<std::string> doubts = geometry::find_doubts(robot.chain(), robot.shapes());
  if (std::string touching = collision::describe_always_touching(robot.planned()->solids);
      !touching.empty())
    doubts.push_back(std::move(touching));
  for (std::string& sentence :
       guided::GeometryWarnings(robot.chain(), robot.shapes()).find(made.problem, made.planned))
    doubts.push_back(std::move(sentence));
  return doubts;
}

/// Either a clearance, which is proven, or a resolution, which is not.
/// \throws Failure(InvalidInput) if both are given, or one is out of its limits.
void read_proof(std::optional<double> clearance, std::optional<double> resolution,
                guided::PlanSettings& settings) {
  if (clearance && resolution)
    throw Failure(invalid_input(
        "plan: takes clearance, which is proven, or resolution, with which nothing is, not both"));
  if (clearance)
    collision::check_clearance("clearance", *clearance);
  if (resolution &&
      !(*resolution >= guided::kLeastResolution && *resolution <= guided::kLargestResolution))
    throw Failure(invalid_input("resolution is " + number_text(*resolution) + ", must be from " +
                                number_text(guided::kLeastResolution) + " to " +
                                number_text(guided::kLargestResolution)));
  settings.clearance_m = resolution ? 0 : clearance.value_or(settings.clearance_m);
  settings.resolution = resolution.value_or(settings.resolution);
}

Plan plan_query(const std::shared_ptr<Robot>& robot, const Problem& problem,
                const std::optional<AnyGuidance>& guided_by, std::optional<std::uint64_t> seed,
                const std::string& sampling_mode, const guided::PlanSettings& settings) {
  Plan made{robot, problem, settings, {}};
  if (seed)
    made.problem.seed = *seed;
  const SharedGuidance guidance = guidance_for(*robot, guided_by);
  const guided::QueryGuidance query = query_of(guidance, made.problem, sampling_mode);
  std::vector<std::string> doubts;
  {
    const py::gil_scoped_release unlocked;
    made.planned = guided::plan_problem(*robot->planned(), made.problem, query, made.settings,
                                        InterruptCheck());
    doubts = doubts_of(*robot, made);
  }
  if (made.planned.interrupted)
    throw py::error_already_set();
  for (const std::string& doubt : doubts)
    warn("GeometryDoubt", doubt);
  for (const std::string& moved : made.planned.moved)
    warn("InputChanged", "problem '" + problem.name + "': " + moved);
  if (!made.planned.attempted)
    throw Failure(ErrorCode::InvalidInput,
                  "problem '" + problem.name + "': " + made.planned.result.reason);
  if (guidance)
    guidance->add(made.planned);
  return made;
}

json::NamedAttempt attempt_for(const Plan& self, const std::string& task,
                               const std::string& machine) {
  json::NamedAttempt named;
  named.attempt = guided::make_attempt({*self.robot->planned(), machine, task}, self.problem,
                                       self.planned, self.settings);
  const Problem& problem = self.problem;
  const bool is_open = problem.scene.objects.empty() && problem.scene.meshes.empty() &&
                       problem.scene.clouds.empty() && problem.attached.empty();
  if (!is_open || problem.constraint)
    named.attempt.scene = guided::record_scene(self.robot->chain(), problem).value_or_throw();
  return named;
}

/// A member of the result, read as it is.
template <typename Value>
auto result(Value ProblemResult::*member) {
  return [member](const Plan& self) { return self.planned.result.*member; };
}

/// What is measured of the path when it is first asked for.
auto measured(std::optional<double> ProblemResult::*member) {
  return [member](Plan& self) {
    ProblemResult& result = self.planned.result;
    if (!result.path_length)
      guided::measure_path(*self.robot->planned(), self.problem, result);
    return result.*member;
  };
}

/// The same of an enumeration, as the words of files.
template <typename Enum>
auto word(Enum ProblemResult::*member) {
  return [member](const Plan& self) { return std::string(to_text(self.planned.result.*member)); };
}

/// Python's checker of configurations, (n, dof) at once, and of whole paths.
/// \throws std::invalid_argument if it answers with another number of answers.
planning::IsFree checker_of(const py::function& free, const py::object& path_free) {
  const planning::IsFree::Ahead ahead = [free](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    const auto answers = py::array_t<bool, py::array::forcecast>::ensure(free(to_rows(qs)));
    if (!answers || answers.ndim() != 1 || answers.shape(0) != qs.cols())
      throw std::invalid_argument("recall: free answers not with one bool for each of " +
                                  std::to_string(qs.cols()) + " configurations");
    const auto is_free = answers.unchecked<1>();
    Eigen::Index count = 0;
    while (count < qs.cols() && is_free(count))
      ++count;
    return count;
  };
  const planning::IsFree::One one = [ahead](const Eigen::VectorXd& q) { return ahead(q) == 1; };
  if (path_free.is_none())
    return {one, ahead};
  return {one, ahead, {}, [path_free](const auto& from, const auto& to) {
            Eigen::MatrixXd path(from.rows(), from.cols() + 1);
            path << from, to.rightCols(1);
            const bool is_free = path_free(to_rows(path)).template cast<bool>();
            return planning::IsFree::Lines(static_cast<std::size_t>(from.cols()), is_free);
          }};
}

std::optional<Array> recall(GuidanceHandle& self, const Problem& problem, const py::function& free,
                            const py::object& path_free, double step) {
  if (!(step >= guided::kLeastResolution && step <= guided::kLargestResolution))
    throw Failure(invalid_input("step is " + number_text(step) + ", must be from " +
                                number_text(guided::kLeastResolution) + " to " +
                                number_text(guided::kLargestResolution)));
  const auto path = self.recall(problem, checker_of(free, path_free), step);
  return path ? std::optional(to_rows(*path)) : std::nullopt;
}

void bind_recall(GuidanceClass& guidance) {
  guidance.def(
      "recall", recall, py::arg("problem"), py::arg("free"), py::arg("path_free") = py::none(),
      py::arg("step") = guided::PlanSettings{}.resolution,
      R"(Tries whole stored paths on a problem with a collision checker of one's own: an answer
without a planner. The most promising first, as long as that is cheaper in the mean than a search.

problem    begins at a configuration; of its scene only names and poses are looked at
free       of (n, dof): (n,) of bool, such as World.free
path_free  of the waypoints of a piece of a path, (n, dof), 2 <= n <= 17: bool, such as
           World.path_free
step       between the configurations that are asked of free, joint units; with path_free they are
           the waypoints

Returns the path, (n, dof), start first, straight in between; None: nothing is recalled, search.
Raises InvalidInput if the problem does not fit the robot, begins at a pose, or has a constraint, which
recalled paths would not keep.)");
}

void bind_ways(GuidanceClass& guidance) {
  guidance
      .def_property_readonly(
          "ways",
          [](const GuidanceHandle& self) {
            const py::object stack = py::module_::import("numpy").attr("stack");
            py::list ways;
            if (self.guidance().experience)
              for (const PosePath& path : self.guidance().experience->experience().paths) {
                py::list poses;
                for (const Eigen::Isometry3d& T_task_transfer : path.poses)
                  poses.append(to_matrix(T_task_transfer));
                ways.append(stack(poses));
              }
            return ways;
          },
          "Stored ways of the transfer frame in the task's frame: (n, 4, 4) each, start first.")
      .def_property_readonly(
          "way_sources",
          [](const GuidanceHandle& self) {
            std::vector<std::string> sources;
            if (self.guidance().experience)
              for (const PosePath& path : self.guidance().experience->experience().paths)
                sources.push_back(path.source.hex());
            return sources;
          },
          "Digests of the robots that took them, way by way.");
}

GuidanceClass bind_guidance(py::module_& module) {
  return GuidanceClass(module, "Guidance",
                       "What guides a robot's queries of a task from one placement: a "
                       "distribution, stored ways of the hand, and how far to trust them. Learns "
                       "from what is planned with it. Threads may share it.")
      .def_static(
          "alone",
          [](const Robot& robot, const std::string& guide) {
            return GuidanceHandle::of_robot(robot, parse_word<Guide>(guide).value_or_throw());
          },
          py::arg("robot"), py::arg("guide") = "retreat",
          "By the robot alone, without experience and server: guide 'retreat', or 'none'.")
      .def_property_readonly("message", &GuidanceHandle::message, "What it is made of, for people.")
      .def_property_readonly(
          "T_task_base", [](const GuidanceHandle& self) { return to_matrix(self.T_task_base()); },
          "Where the robot stands for which it was made: (4, 4), or None: not told.")
      .def("__repr__",
           [](const GuidanceHandle& self) { return "<kinship.Guidance " + self.message() + ">"; })
      .def_property_readonly(
          "guide",
          [](const GuidanceHandle& self) { return std::string(to_text(self.guidance().guide)); },
          "What of retreat, stored ways and mixture a guided query uses.")
      .def_property_readonly(
          "share", [](const GuidanceHandle& self) { return self.guidance().guided_fraction; },
          "Of guided samples in a guided query, 0 to 1.")
      .def_property_readonly("guided_part", &GuidanceHandle::guided_part,
                             "Probability that the next query is guided, not planned uniformly to "
                             "compare.")
      .def_property_readonly(
          "distribution_id",
          [](const GuidanceHandle& self) {
            const auto& id = self.guidance().distribution_id;
            return id ? std::optional(id->hex()) : std::nullopt;
          },
          "Of its distribution; None: it has none.")
      .def_property_readonly(
          "revision", [](const GuidanceHandle& self) { return self.guidance().revision; },
          "Of its distribution.");
}

void bind_outcome(py::class_<Plan>& plan) {
  plan.def_property_readonly("solved", result(&ProblemResult::solved), "Whether there is a path.")
      .def_property_readonly(
          "waypoints",
          [](const Plan& self) {
            const auto& waypoints = self.planned.result.waypoints;
            return waypoints ? std::optional(to_rows(*waypoints)) : std::nullopt;
          },
          "(n, dof), start first, straight in between; None if not solved.")
      .def_property_readonly("reason", result(&ProblemResult::reason), "Why it is not solved.")
      .def_property_readonly("collision_checks", result(&ProblemResult::collision_checks),
                             "Of planning.")
      .def_property_readonly("goal_checks", result(&ProblemResult::goal_checks),
                             "Of goal configurations, before planning.")
      .def_property_readonly("shortcut_checks", result(&ProblemResult::shortcut_checks),
                             "Of shortening the path, afterwards.")
      .def_property_readonly("proven", result(&ProblemResult::proven),
                             "Whether nothing touches between the waypoints, surely.")
      .def_property_readonly("path_length", measured(&ProblemResult::path_length),
                             "In joint units; like the next two, None if not solved.")
      .def_property_readonly("hand_length", measured(&ProblemResult::hand_length_m),
                             "Of the way of the transfer frame, m.")
      .def_property_readonly(
          "least_clearance", measured(&ProblemResult::least_clearance_m),
          "Of what moves from the obstacles, at steps of 0.05, m; 0.1 if nothing is nearer.")
      .def_property_readonly("refuted_edges", result(&ProblemResult::refuted_edges),
                             "Free where they were checked but not in between: planned again.")
      .def_property_readonly("projections", result(&ProblemResult::projections),
                             "Onto a constraint.")
      .def_property_readonly("processor_time_s", result(&ProblemResult::processor_time_s),
                             "CPU time of the thread for all of it: start, goals, guidance, "
                             "search, shortening, proof.")
      .def_property_readonly("planning_time_s", result(&ProblemResult::planning_time_s),
                             "Of this thread, without goals and shortening.")
      .def_property_readonly("planner", result(&ProblemResult::planner), "What planned it.");
}

void bind_guided(py::class_<Plan>& plan) {
  plan.def_property_readonly("sampling_mode", word(&ProblemResult::sampling_mode),
                             "'guided', 'control' (uniform to compare) or 'uniform'.")
      .def_property_readonly("share", result(&ProblemResult::share), "Of guided samples.")
      .def_property_readonly("gate_fired", result(&ProblemResult::gate_fired),
                             "Whether the query is far from all that the mixture knows.")
      .def_property_readonly("guide", word(&ProblemResult::guide),
                             "What of recall, retreat, ways and mixture guided it.")
      .def_property_readonly("track_share", result(&ProblemResult::track_share),
                             "Of samples around stored ways, a part of share.")
      .def_property_readonly("tracks_followed", result(&ProblemResult::tracks_followed),
                             "Stored ways that were tried.")
      .def_property_readonly("recall_tries", result(&ProblemResult::recall_tries),
                             "Whole stored paths that were tried before a search.")
      .def_property_readonly("found_by", word(&ProblemResult::found_by),
                             "'recalled', 'straight_line', 'track', 'search' or 'nothing'.")
      .def_property_readonly("guidance_reason", result(&ProblemResult::guidance_reason),
                             "Why it was not guided, or less than wanted.")
      .def("attempt", attempt_for, py::arg("task"), py::arg("machine") = "",
           "What the server is to be told of it, with its scene: for Client.report().")
      .def("__repr__", [](const Plan& self) {
        const ProblemResult& result = self.planned.result;
        return "<kinship.Plan '" + self.problem.name + "' " +
               (result.solved ? "solved, " + std::to_string(result.waypoints->cols()) + " waypoints"
                              : "not solved: " + result.reason) +
               ", " + std::to_string(result.collision_checks) + " checks>";
      });
}

}  // namespace

void bind_planning(py::module_& module) {
  GuidanceClass guidance = bind_guidance(module);
  bind_ways(guidance);
  bind_recall(guidance);
  py::class_<Plan> outcome(module, "Plan", "What came of planning a problem.");
  bind_outcome(outcome);
  bind_guided(outcome);
  module.def(
      "plan",
      [](const std::shared_ptr<Robot>& robot, const Problem& problem,
         const std::optional<AnyGuidance>& guidance, std::optional<std::uint64_t> seed,
         const std::string& sampling_mode, const std::string& planner, std::uint64_t max_checks,
         std::optional<double> clearance, std::optional<double> resolution,
         std::uint64_t shortcut_checks, int max_goals, std::optional<double> limit_slack,
         double overshoot, double gate_distance, double retreat) {
        guided::PlanSettings settings;
        settings.max_checks = max_checks;
        read_proof(clearance, resolution, settings);
        settings.shortcut_checks = shortcut_checks;
        settings.max_goals = max_goals;
        settings.limit_slack =
            limit_slack.value_or(robot->limit_slack().value_or(settings.limit_slack));
        settings.overshoot = overshoot;
        settings.gate_distance = gate_distance;
        settings.tracks.retreat_m = retreat;
        if (!planner.empty())
          settings.planner = ompl_planners::parse_planner(planner).value_or_throw();
        return plan_query(robot, problem, guidance, seed, sampling_mode, settings);
      },
      py::arg("robot"), py::arg("problem"), py::arg("guidance") = py::none(), py::kw_only(),
      py::arg("seed") = py::none(), py::arg("sampling_mode") = "", py::arg("planner") = "",
      py::arg("max_checks") = guided::PlanSettings{}.max_checks, py::arg("clearance") = py::none(),
      py::arg("resolution") = py::none(),
      py::arg("shortcut_checks") = guided::PlanSettings{}.shortcut_checks,
      py::arg("max_goals") = guided::PlanSettings{}.max_goals, py::arg("limit_slack") = py::none(),
      py::arg("overshoot") = guided::PlanSettings{}.overshoot,
      py::arg("gate_distance") = guided::PlanSettings{}.gate_distance,
      py::arg("retreat") = guided::PlanSettings{}.tracks.retreat_m,
      R"(Plans a problem as kinship-plan does; other threads run meanwhile, and Ctrl-C ends it.

guidance         of Client.guidance(), or a Distribution; None: uniform
seed             instead of the problem's: equal seed, equal path
sampling_mode    'guided', 'control' or 'uniform'; empty: chosen as the evidence says
planner          'birrt', 'cbirrt2', 'roadmap' or 'ompl:NAME'; empty: as the problem needs
max_checks       collision checks after which it gives up
clearance        what comes nearer to an obstacle counts as touching, m, by default 0.001: every edge
                 of the path is proven; of the robot's own links at most 0.001 is asked
resolution       instead of a proof: between checked configurations, joint units
shortcut_checks  spent on shortening the path
max_goals        goal configurations found for a goal pose
limit_slack      a start or goal beyond a limit by less is moved onto it, joint units; by default
                 what the robot's chain.toml says, or 0.0001
overshoot        trees grow this much farther than the sample, 1 or more
gate_distance    of a query to what the mixture knows: beyond it the mixture gives fewer samples
retreat          the hand backs out of its goal so far, m

A problem that has no path is an answer with its reason. Raises InvalidInput if the problem does not
fit the robot, or the guidance is another robot's. Warns with GeometryDoubt of solids that cannot be
meant: of a robot that has none, a mesh a thousand times too large, an obstacle out of reach.)");
}

}  // namespace kinship::python
