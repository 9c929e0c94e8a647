#include <pybind11/stl.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "proto/types/problem.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"

namespace kinship::python {
namespace {

using AllowedPairs = std::vector<std::pair<std::string, std::string>>;

/// A collision world that threads may share: one asks at a time.
class World {
 public:
  World(const std::shared_ptr<Robot>& robot, const collision::Surroundings& surroundings)
      : robot_(robot), world_(robot->planned()->solids, surroundings), prover_(world_) {}

  const Robot& robot() const noexcept { return *robot_; }

  /// \param qs  dof x n.
  std::vector<bool> free(const Eigen::MatrixXd& qs) {
    constexpr Eigen::Index kTogether = 16;  // cost little more than one
    const std::scoped_lock lock(mutex_);
    std::vector<bool> is_free(static_cast<std::size_t>(qs.cols()), false);
    for (Eigen::Index at = 0; at < qs.cols(); ++at) {  // past the one that collides
      const Eigen::Index width = std::min(kTogether, qs.cols() - at);
      const Eigen::Index count = world_.free_ahead(qs.middleCols(at, width));
      std::fill_n(is_free.begin() + at, count, true);
      at += count < width ? count : count - 1;
    }
    return is_free;
  }

  std::optional<std::pair<std::string, std::string>> contact(const Eigen::VectorXd& q) {
    const std::scoped_lock lock(mutex_);
    return world_.find_contact(q);
  }

  /// \param waypoints  dof x n. \return whether every line between two is proven to be free.
  bool edges_free(const Eigen::MatrixXd& waypoints, double clearance_m) {
    const std::scoped_lock lock(mutex_);
    const Eigen::Index count = waypoints.cols() - 1;
    return std::ranges::all_of(
        prover_.prove_all(waypoints.leftCols(count), waypoints.rightCols(count), {clearance_m}),
        &collision::EdgeProof::is_free);
  }

 private:
  std::shared_ptr<Robot> robot_;
  std::mutex mutex_;  // guards the world and what asks it
  collision::CollisionWorld world_;
  collision::EdgeProver prover_;
};

py::object free_of(World& world, const Array& q) {
  const Robot& robot = world.robot();
  const Configurations configurations =
      read_configurations(q, robot.chain().dof(), robot.description().label);
  std::vector<bool> is_free;
  {
    const py::gil_scoped_release unlocked;
    is_free = world.free(configurations.columns);
  }
  if (configurations.is_one)
    return py::bool_(is_free.front());
  py::array_t<bool> answers(static_cast<py::ssize_t>(is_free.size()));
  std::copy(is_free.begin(), is_free.end(), answers.mutable_data());
  return answers;
}

std::optional<std::pair<std::string, std::string>> contact_of(World& world, const Array& q) {
  const Robot& robot = world.robot();
  const Configurations configuration =
      read_configurations(q, robot.chain().dof(), robot.description().label);
  if (!configuration.is_one)
    throw std::invalid_argument("contact: takes one configuration");
  const py::gil_scoped_release unlocked;
  return world.contact(configuration.columns);
}

bool edge_free_of(World& world, const Array& from, const Array& to, double clearance) {
  const Robot& robot = world.robot();
  const auto end = [&](const Array& q) {
    const Configurations end =
        read_configurations(q, robot.chain().dof(), robot.description().label);
    if (!end.is_one)
      throw std::invalid_argument(
          "edge_free: an edge lies between two configurations, (dof,) each");
    return end.columns;
  };
  Eigen::MatrixXd ends(robot.chain().dof(), 2);
  ends << end(from), end(to);
  const py::gil_scoped_release unlocked;
  return world.edges_free(ends, clearance);
}

bool path_free_of(World& world, const Array& waypoints, double clearance) {
  const Robot& robot = world.robot();
  const Configurations path =
      read_configurations(waypoints, robot.chain().dof(), robot.description().label);
  if (path.is_one || path.columns.cols() < 2)
    throw std::invalid_argument("path_free: a path has at least two waypoints, (n, dof)");
  const py::gil_scoped_release unlocked;
  return world.edges_free(path.columns, clearance);
}

std::unique_ptr<World> world_of_problem(const std::shared_ptr<Robot>& robot,
                                        const Problem& problem) {
  const py::gil_scoped_release unlocked;
  return std::make_unique<World>(
      robot, collision::Surroundings{
                 .T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity()),
                 .scene = problem.scene,
                 .attached = problem.attached,
                 .allowed_collisions = problem.allowed_collisions});
}

}  // namespace

void bind_worlds(py::module_& module) {
  py::class_<World>(module, "World",
                    "A robot among obstacles that says which configurations are free. Threads may "
                    "share it, and ask one after the other.")
      .def(py::init([](const std::shared_ptr<Robot>& robot, const Scene& scene,
                       const std::optional<Array>& T_task_base, const AllowedPairs& allowed) {
             collision::Surroundings surroundings;
             surroundings.scene = scene;
             surroundings.allowed_collisions = allowed;
             if (T_task_base)
               surroundings.T_task_base = read_pose(*T_task_base, "T_task_base");
             const py::gil_scoped_release unlocked;
             return std::make_unique<World>(robot, surroundings);
           }),
           py::arg("robot"), py::arg("scene") = Scene(), py::kw_only(),
           py::arg("T_task_base") = py::none(), py::arg("allowed_collisions") = AllowedPairs(),
           R"(Puts a robot into a scene.

T_task_base         where its base stands in the task's frame; by default at its origin
allowed_collisions  pairs of names, of links or obstacles, that may touch

Raises InvalidInput if the robot's collision geometry is not known, or a shape is not proper.)")
      .def_static("of_problem", world_of_problem, py::arg("robot"), py::arg("problem"),
                  "The world of a problem, with what the robot holds in it.")
      .def("free", free_of, py::arg("q"),
           "Whether configurations touch nothing: a bool for (dof,), n of them for (n, dof). "
           "Limits are not checked.")
      .def("edge_free", edge_free_of, py::arg("from_q"), py::arg("to_q"), py::kw_only(),
           py::arg("clearance") = collision::EdgeProofOptions{}.clearance_m,
           "Whether the straight line between two configurations, (dof,) each, is proven to touch "
           "nothing. What comes nearer than the clearance, m, where it is looked at, counts as "
           "touching.")
      .def("path_free", path_free_of, py::arg("waypoints"), py::kw_only(),
           py::arg("clearance") = collision::EdgeProofOptions{}.clearance_m,
           "The same of all lines between the waypoints of a path, (n, dof).")
      .def("contact", contact_of, py::arg("q"),
           "Names of two things that touch at q, (dof,); None if none do.");
}

}  // namespace kinship::python
