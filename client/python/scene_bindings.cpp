#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <fstream>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "proto/files/lines.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/scene_names.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::python {
namespace {

using Packages = std::map<std::string, std::string>;
using NamePairs = std::vector<std::pair<std::string, std::string>>;

models::PackageFolders folders_of(const Packages& packages) {
  return {packages.begin(), packages.end()};
}

std::size_t obstacle_count(const Scene& scene) {
  return scene.objects.size() + scene.meshes.size() + scene.clouds.size();
}

std::string obstacles_text(const Scene& scene) {
  return std::to_string(obstacle_count(scene)) + " obstacles";
}

/// \throws Failure(InvalidInput) for a name that is empty or another object's.
void require_new_name(const Scene& scene, const std::string& name) {
  if (name.empty())
    throw Failure(invalid_input("object: its name is empty"));
  if (has_object(scene, name))
    throw Failure(invalid_input("object '" + name +
                                "': the scene has one of this name; each needs a name of its own"));
}

void add_solid(Scene& scene, const std::string& name, const Array& pose, const Shape& shape) {
  require_new_name(scene, name);
  if (const auto why = geometry::broken_rule(shape))
    throw Failure(invalid_input("object '" + name + "': " + *why));
  scene.objects.push_back({.name = name, .shape = shape, .T_task_object = read_pose(pose, name)});
}

Eigen::Vector3d read_triple(const Array& values, const char* name) {
  if (values.ndim() != 1 || values.shape(0) != 3)
    throw std::invalid_argument(std::string(name) + ": must be three numbers");
  return Eigen::Map<const Eigen::Vector3d>(values.data());
}

/// Reads the files that a scene names at once, so that the caller gets their faults.
void add_mesh(Scene& scene, const std::string& name, const std::string& file, const Array& pose,
              const Array& scale, const Packages& packages) {
  require_new_name(scene, name);
  const Eigen::Vector3d factors = read_triple(scale, "scale");
  if (!factors.allFinite() || (factors.array() == 0).any())
    throw Failure(invalid_input("object '" + name + "': scale must be three numbers other than 0"));
  Scene mesh{.objects = {}};
  mesh.meshes.push_back({.name = name,
                         .mesh = {.file = file, .scale = factors},
                         .T_task_mesh = read_pose(pose, name)});
  std::vector<AttachedObject> none;
  const py::gil_scoped_release unlocked;
  if (const auto error = models::SceneMeshes({}, folders_of(packages)).read(mesh, none))
    throw Failure(*error);
  scene.meshes.push_back(std::move(mesh.meshes.front()));
}

std::vector<Problem> read_problems(const std::filesystem::path& file, const Packages& packages) {
  const py::gil_scoped_release unlocked;
  std::ifstream stream = files::open_input(file);
  models::SceneMeshes meshes(file.parent_path(), folders_of(packages));
  std::vector<Problem> problems;
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    auto problem = line.text ? json::problem_from_json(*line.text) : line.text.error();
    const auto error = problem ? std::nullopt : std::optional(problem.error());
    const auto where = "'" + file.string() + "' line " + std::to_string(line.number) + ": ";
    if (error)
      throw Failure(error->code, where + error->message);
    problems.push_back(std::move(problem).value());
    if (const auto unread = meshes.read(problems.back().scene, problems.back().attached))
      throw Failure(unread->code, where + unread->message);
    return true;
  });
  return problems;
}

/// Goals of a problem, as Python says them: configurations, or where the hand is to get.
struct Goals {
  std::optional<Array> configurations, pose;
};

Problem make_problem(const std::string& name, const Array& start, const Goals& goals,
                     const std::optional<Array>& T_task_base) {
  if (start.ndim() != 1)
    throw std::invalid_argument("start: must be one configuration");
  if (goals.configurations.has_value() == goals.pose.has_value())
    throw std::invalid_argument("Problem: give goal or goal_pose, one of the two");
  Problem problem;
  problem.name = name;
  problem.start = Eigen::Map<const Eigen::VectorXd>(start.data(), start.size());
  problem.goal_configurations.resize(start.size(), 0);
  if (goals.configurations)
    problem.goal_configurations =
        read_configurations(*goals.configurations, start.size(), "goal").columns;
  if (!problem.start.allFinite() || !problem.goal_configurations.allFinite())
    throw std::invalid_argument("Problem '" + name + "': start and goal must be finite");
  problem.T_task_goal = read_pose(goals.pose, "goal_pose");
  problem.T_task_base = read_pose(T_task_base, "T_task_base");
  return problem;
}

using ProblemClass = py::class_<Problem>;

void bind_making(ProblemClass& bound) {
  bound.def(
      py::init([](const std::string& name, const Array& start, const std::optional<Array>& goal,
                  const std::optional<Array>& goal_pose, const Scene& scene,
                  const std::optional<Array>& T_task_base, const NamePairs& allowed_collisions,
                  double time_limit_s, std::uint64_t seed) {
        Problem problem = make_problem(name, start, {goal, goal_pose}, T_task_base);
        problem.scene = scene;
        problem.allowed_collisions = allowed_collisions;
        problem.time_limit_s = time_limit_s;
        problem.seed = seed;
        return problem;
      }),
      py::arg("name"), py::arg("start"), py::arg("goal") = py::none(), py::kw_only(),
      py::arg("goal_pose") = py::none(), py::arg("scene") = Scene(),
      py::arg("T_task_base") = py::none(), py::arg("allowed_collisions") = NamePairs(),
      py::arg("time_limit_s") = Problem{}.time_limit_s, py::arg("seed") = 0,
      R"(A query of one robot.

start               (dof,)
goal                (dof,), or (n, dof): any of them
goal_pose           instead of goal, where the transfer frame is to get in the task's frame
scene               what is around the robot
T_task_base         where its base stands in the task's frame
allowed_collisions  pairs of names, of links or obstacles, that may touch
time_limit_s        of wall-clock time)");
}

void bind_problem(py::module_& module) {
  ProblemClass bound(module, "Problem", R"(A planning problem, a line of a problem file.

>>> problem = kinship.Problem("over", [0.0, 0.5], [[1.0, 0.5], [1.0, -0.5]], seed=3)
>>> problem.goal_configurations.shape
(2, 2)
>>> kinship.Problem.from_json(problem.to_json()).start
array([0. , 0.5]))");
  bind_making(bound);
  bound
      .def_static(
          "from_json",
          [](const std::string& text) {
            Problem problem = json::problem_from_json(text).value_or_throw();
            if (const auto error =
                    models::SceneMeshes({}, {}).read(problem.scene, problem.attached))
              throw Failure(*error);
            return problem;
          },
          py::arg("text"), "Reads one line; meshes are named relative to the current folder.")
      .def(
          "to_json", [](const Problem& self) { return json::to_json(self); },
          "The line of a problem file.")
      .def_readonly("name", &Problem::name, "What messages call it.")
      .def_property_readonly(
          "start", [](const Problem& self) { return to_vector(self.start); },
          "(dof,); (0,) if a pose is given.")
      .def_property_readonly(
          "T_task_start", [](const Problem& self) { return to_matrix(self.T_task_start); },
          "Where the transfer frame begins: (4, 4), or None if a configuration is given.")
      .def_property_readonly(
          "goal_configurations",
          [](const Problem& self) { return to_rows(self.goal_configurations); },
          "(n, dof); n is 0 if a pose is the goal.")
      .def_property_readonly(
          "T_task_goal", [](const Problem& self) { return to_matrix(self.T_task_goal); },
          "Where the transfer frame is to get: (4, 4), or None if configurations are the goal.")
      .def_property_readonly(
          "T_task_base", [](const Problem& self) { return to_matrix(self.T_task_base); },
          "Where the robot stands in the task's frame: (4, 4), or None: not said.")
      .def_readonly("scene", &Problem::scene, "What is around the robot.")
      .def_readonly("time_limit_s", &Problem::time_limit_s, "Of wall-clock time.")
      .def_readonly("seed", &Problem::seed, "Of the planner.")
      .def("__repr__", [](const Problem& self) {
        return "<kinship.Problem '" + self.name + "' among " + obstacles_text(self.scene) + ">";
      });
}

}  // namespace

void bind_scenes(py::module_& module) {
  const Array identity = to_matrix(Eigen::Isometry3d::Identity());
  const std::vector<double> ones = {1, 1, 1};
  py::class_<Scene>(module, "Scene",
                    R"(Obstacles in the task's frame. Poses are those of centres: (4, 4), or (7,).

Each has a name of its own. Adding one raises InvalidInput with its name for a name that is there
already, and for a size that is not above 0 or above 1000 m.

>>> scene = kinship.Scene()
>>> scene.add_box("table", [0.6, 0, -0.05, 0, 0, 0, 1], [0.8, 1.2, 0.1])
>>> len(scene)
1)")
      .def(py::init<>(), "An empty scene.")
      .def("__repr__",
           [](const Scene& self) { return "<kinship.Scene of " + obstacles_text(self) + ">"; })
      .def(
          "add_box",
          [](Scene& self, const std::string& name, const Array& pose, const Array& size) {
            add_solid(self, name, pose, BoxShape{read_triple(size, "size")});
          },
          py::arg("name"), py::arg("pose"), py::arg("size"), "size: full extents, m.")
      .def(
          "add_cylinder",
          [](Scene& self, const std::string& name, const Array& pose, double radius,
             double length) {
            add_solid(self, name, pose, CylinderShape{radius, length});
          },
          py::arg("name"), py::arg("pose"), py::arg("radius"), py::arg("length"), "Along z; m.")
      .def(
          "add_capsule",
          [](Scene& self, const std::string& name, const Array& pose, double radius,
             double length) {
            add_solid(self, name, pose, CapsuleShape{radius, length});
          },
          py::arg("name"), py::arg("pose"), py::arg("radius"), py::arg("length"),
          "Along z; length is that of the cylindrical part, m.")
      .def(
          "add_sphere",
          [](Scene& self, const std::string& name, const Array& center, double radius) {
            Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
            pose.translation() = read_triple(center, "center");
            add_solid(self, name, to_matrix(pose), SphereShape{radius});
          },
          py::arg("name"), py::arg("center"), py::arg("radius"), "center: (3,), m.")
      .def("add_mesh", add_mesh, py::arg("name"), py::arg("file"), py::arg("pose") = identity,
           py::arg("scale") = ones, py::arg("packages") = Packages(),
           "Reads a surface of triangles (STL, OBJ, DAE). What lies wholly inside does not touch "
           "it.")
      .def("__len__", obstacle_count, "Number of obstacles.");
  bind_problem(module);
  module.def("read_problems", read_problems, py::arg("file"), py::arg("packages") = Packages(),
             "Reads a problem file, JSON Lines as kinship-plan takes them, with its meshes.\n\n"
             "Raises NotFound, InvalidInput or TooLarge with the file, line and value.");
}

}  // namespace kinship::python
