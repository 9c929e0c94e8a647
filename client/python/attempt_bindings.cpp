#include <pybind11/stl.h>

#include <cstdint>
#include <utility>

#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "client/python/robot_names.hpp"
#include "client/python/sampled_distribution.hpp"
#include "proto/evidence/machine_speed.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::python {
namespace {

using json::NamedAttempt;
using AttemptClass = py::class_<NamedAttempt>;

void set_waypoints(NamedAttempt& self, const std::optional<Array>& waypoints) {
  if (waypoints && waypoints->ndim() != 2)
    throw std::invalid_argument("waypoints: must be (n, dof)");
  self.attempt.path.reset();
  if (waypoints)
    self.attempt.path.emplace(
        read_configurations(*waypoints, waypoints->shape(1), "a waypoint").columns);
}

/// The surroundings of a robot, as other robots can use them.
RecordedScene recorded(const Scene& scene) {
  if (!scene.meshes.empty() || !scene.clouds.empty())
    throw std::invalid_argument("scene: an attempt takes boxes, cylinders, spheres and capsules");
  RecordedScene record;
  record.objects = scene.objects;
  return record;
}

NamedAttempt make_attempt(const std::string& task, const RobotName& robot,
                          const std::optional<Array>& waypoints, const py::kwargs& others) {
  NamedAttempt made;
  made.attempt.report_uuid = Uuid::random();
  made.attempt.task = task;
  set_robot(made, robot);
  set_waypoints(made, waypoints);
  made.attempt.record.outcome = waypoints ? Outcome::Solved : Outcome::Failed;
  const py::object self = py::cast(&made);
  for (const auto& [name, value] : others)
    py::setattr(self, name, value);
  return made;
}

/// A member of the planning record, to be read and written.
template <typename Value>
void bind_member(AttemptClass& attempt, const char* name, Value PlanningRecord::*member,
                 const char* what) {
  attempt.def_property(
      name, [member](const NamedAttempt& self) { return self.attempt.record.*member; },
      [member](NamedAttempt& self, const Value& value) { self.attempt.record.*member = value; },
      what);
}

/// The same of an enumeration, as the words of files.
template <typename Enum>
void bind_word(AttemptClass& attempt, const char* name, Enum PlanningRecord::*member,
               const char* what) {
  attempt.def_property(
      name,
      [member](const NamedAttempt& self) {
        return std::string(to_text(self.attempt.record.*member));
      },
      [member](NamedAttempt& self, const std::string& word) {
        self.attempt.record.*member = parse_word<Enum>(word).value_or_throw();
      },
      what);
}

void bind_record(AttemptClass& attempt) {
  bind_word(attempt, "outcome", &PlanningRecord::outcome, "'solved', 'timeout' or 'failed'.");
  bind_word(attempt, "sampling_mode", &PlanningRecord::sampling_mode,
            "'guided', 'control' (uniform to compare) or 'uniform' (there was no guidance).");
  bind_member(attempt, "planner", &PlanningRecord::planner, "Its name.");
  bind_member(attempt, "planner_options", &PlanningRecord::planner_options, "Free text.");
  bind_member(attempt, "planning_time_s", &PlanningRecord::planning_time_s, "0 or more.");
  attempt.def_property(
      "processor_time_s",
      [](const NamedAttempt& self) { return self.attempt.record.processor_time_s; },
      [](NamedAttempt& self, double time_s) {
        self.attempt.record.processor_time_s = time_s;
        self.attempt.record.machine_speed = time_s > 0 ? evidence::machine_speed() : 0;
      },
      "Of the query on this machine, with everything that guidance costs; 0: unknown.");
  bind_member(attempt, "time_limit_s", &PlanningRecord::time_limit_s, "0: none said.");
  bind_member(attempt, "collision_checks", &PlanningRecord::collision_checks,
              "Configurations of which any collision question was asked.");
  bind_member(attempt, "share", &PlanningRecord::share, "Of guided samples, 0 to 1.");
}

void bind_path(AttemptClass& attempt) {
  attempt
      .def_property_readonly(
          "report_uuid", [](const NamedAttempt& self) { return self.attempt.report_uuid.text(); },
          "What the server knows it by: sent twice, it counts once.")
      .def_property(
          "task", [](const NamedAttempt& self) { return self.attempt.task; },
          [](NamedAttempt& self, const std::string& task) { self.attempt.task = task; },
          "Its name.")
      .def_property(
          "robot",
          [](const NamedAttempt& self) {
            return self.label.empty() ? self.attempt.robot.hex() : self.label;
          },
          set_robot, "Digest, or the label by which a file named it. Also takes a Robot.")
      .def_property(
          "machine", [](const NamedAttempt& self) { return self.attempt.machine; },
          [](NamedAttempt& self, const std::string& machine) { self.attempt.machine = machine; },
          "Where it was planned.")
      .def_property(
          "T_task_base",
          [](const NamedAttempt& self) { return to_matrix(self.attempt.T_task_base); },
          [](NamedAttempt& self, const std::optional<Array>& pose) {
            self.attempt.T_task_base = read_pose(pose, "T_task_base");
          },
          "Where the robot's base stood in the task's frame: (4, 4), or None: not said.")
      .def_property(
          "waypoints",
          [](const NamedAttempt& self) {
            return self.attempt.path ? std::optional(to_rows(self.attempt.path->waypoints()))
                                     : std::nullopt;
          },
          set_waypoints, "(n, dof), start first; None if unsolved.")
      .def_property(
          "scene",
          [](const NamedAttempt& self) {
            return self.attempt.scene ? std::optional(Scene{.objects = self.attempt.scene->objects})
                                      : std::nullopt;
          },
          [](NamedAttempt& self, const std::optional<Scene>& scene) {
            self.attempt.scene = scene ? std::optional(recorded(*scene)) : std::nullopt;
          },
          "What was around the robot, in the task's frame: primitives only; None: not said.")
      .def_property(
          "search",
          [](const NamedAttempt& self) -> py::object {
            if (!self.attempt.search)
              return py::none();
            return py::module_::import("json").attr("loads")(json::to_json(*self.attempt.search));
          },
          [](NamedAttempt& self, const py::object& search) {
            self.attempt.search.reset();
            if (!search.is_none())
              self.attempt.search =
                  json::search_record_from_json(
                      py::module_::import("json").attr("dumps")(search).cast<std::string>())
                      .value_or_throw();
          },
          "What explains it: a dict with start, goals, blockers, goal_contacts, last_free, reason "
          "... as proto/FORMATS.md has them; None: not said.");
}

}  // namespace

void bind_attempts(py::module_& module) {
  AttemptClass attempt(module, "Attempt",
                       "One planning query: solved, with a path, or not. What a client reports and "
                       "experience files hold.");
  attempt.def(py::init(&make_attempt), py::arg("task"), py::arg("robot"),
              py::arg("waypoints") = py::none(),
              R"(An attempt with a UUID of its own.

robot      a Robot, or its digest
waypoints  (n, dof), start first; None: unsolved
others     by name, any property that can be set: planner="mine", collision_checks=812)");
  bind_path(attempt);
  bind_record(attempt);
  attempt
      .def(
          "guided_by",
          [](NamedAttempt& self, const SampledDistribution& distribution, double share) {
            PlanningRecord& record = self.attempt.record;
            record.sampling_mode = SamplingMode::Guided;
            record.share = share;
            record.distribution_id = distribution.value()->id;
            record.distribution_revision = distribution.value()->revision;
          },
          py::arg("distribution"), py::arg("share"),
          "Says that this share of its samples came from a distribution.")
      .def_static(
          "from_json",
          [](const std::string& text) { return json::attempt_from_json(text).value_or_throw(); },
          py::arg("text"), "Reads a line of an experience file.")
      .def(
          "to_json", [](const NamedAttempt& self) { return json::to_json(attempt_of(self)); },
          "The line of an experience file.")
      .def("__repr__", [](const NamedAttempt& self) {
        return "<kinship.Attempt " + self.attempt.report_uuid.text() + " at '" + self.attempt.task +
               "', " + std::string(to_text(self.attempt.record.outcome)) + ">";
      });
}

}  // namespace kinship::python
