#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

/// The proof of a path: of its first line that is not free, and of the lines before it.
struct PathProof {
  std::size_t edges = 0;  ///< proven to be free, from the first on
  std::optional<collision::EdgeRefutation> refutation = {};
  double least_clearance_m = std::numeric_limits<double>::infinity();
};

/// A collision world that threads may share: one asks at a time.
class World {
 public:
  World(const std::shared_ptr<Robot>& robot, const collision::Surroundings& surroundings)
      : robot_(robot), world_(robot->planned()->solids, surroundings), prover_(world_) {}

  const Robot& robot() const noexcept { return *robot_; }

  /// \param qs  dof x n. \param clearance_m  0: free means without contact
  std::vector<bool> free(const Eigen::MatrixXd& qs, double clearance_m) {
    constexpr Eigen::Index kTogether = 16;  // cost little more than one
    const std::scoped_lock lock(mutex_);
    std::vector<bool> is_free(static_cast<std::size_t>(qs.cols()), false);
    for (Eigen::Index at = 0; at < qs.cols(); ++at) {  // past the one that collides
      const Eigen::Index width = std::min(kTogether, qs.cols() - at);
      const auto together = qs.middleCols(at, width);
      const Eigen::Index count = clearance_m == 0 ? world_.free_ahead(together)
                                                  : prover_.clear_ahead(together, {clearance_m});
      std::fill_n(is_free.begin() + at, count, true);
      at += count < width ? count : count - 1;
    }
    return is_free;
  }

  std::optional<std::pair<std::string, std::string>> contact(const Eigen::VectorXd& q,
                                                             double clearance_m) {
    const std::scoped_lock lock(mutex_);
    if (clearance_m == 0)
      return world_.find_contact(q);
    const std::vector<collision::NearPair> near = prover_.find_near(q, {clearance_m});
    const auto nearest = std::ranges::min_element(near, {}, &collision::NearPair::clearance_m);
    return nearest == near.end() ? std::nullopt
                                 : std::optional(std::pair(nearest->first, nearest->second));
  }

  /// \param waypoints  dof x n. \return of the first line between two that is not proven to be
  ///                   free, and of the lines before it.
  PathProof prove(const Eigen::MatrixXd& waypoints, double clearance_m) {
    const std::scoped_lock lock(mutex_);
    const Eigen::Index count = waypoints.cols() - 1;
    PathProof known;
    for (const collision::EdgeProof& proof :
         prover_.prove_all(waypoints.leftCols(count), waypoints.rightCols(count), {clearance_m})) {
      known.least_clearance_m = std::min(known.least_clearance_m, proof.least_clearance_m);
      known.refutation = proof.refutation;
      if (!proof.is_free())
        break;
      ++known.edges;
    }
    return known;
  }

 private:
  std::shared_ptr<Robot> robot_;
  std::mutex mutex_;  // guards the world and its users
  collision::CollisionWorld world_;
  collision::EdgeProver prover_;
};

/// \throws Failure(InvalidInput) as collision::check_clearance(), unless it is 0.
void check_clearance_or_0(double clearance) {
  if (clearance != 0)
    collision::check_clearance("clearance", clearance);
}

py::object free_of(World& world, const Array& q, double clearance) {
  check_clearance_or_0(clearance);
  const Robot& robot = world.robot();
  const Configurations configurations =
      read_configurations(q, robot.chain().dof(), robot.description().label);
  std::vector<bool> is_free;
  {
    const py::gil_scoped_release unlocked;
    is_free = world.free(configurations.columns, clearance);
  }
  if (configurations.is_one)
    return py::bool_(is_free.front());
  py::array_t<bool> answers(static_cast<py::ssize_t>(is_free.size()));
  std::copy(is_free.begin(), is_free.end(), answers.mutable_data());
  return answers;
}

std::optional<std::pair<std::string, std::string>> contact_of(World& world, const Array& q,
                                                              double clearance) {
  check_clearance_or_0(clearance);
  const Robot& robot = world.robot();
  const Configurations configuration =
      read_configurations(q, robot.chain().dof(), robot.description().label);
  if (!configuration.is_one)
    throw std::invalid_argument("contact: takes one configuration");
  const py::gil_scoped_release unlocked;
  return world.contact(configuration.columns, clearance);
}

bool edge_free_of(World& world, const Array& from, const Array& to, double clearance) {
  const Robot& robot = world.robot();
  const auto end = [&](const Array& q) {
    const Configurations configuration =
        read_configurations(q, robot.chain().dof(), robot.description().label);
    if (!configuration.is_one)
      throw std::invalid_argument(
          "edge_free: an edge lies between two configurations, (dof,) each");
    return configuration.columns;
  };
  Eigen::MatrixXd ends(robot.chain().dof(), 2);
  ends << end(from), end(to);
  const py::gil_scoped_release unlocked;
  return !world.prove(ends, clearance).refutation;
}

PathProof proof_of(World& world, const Array& waypoints, double clearance) {
  const Robot& robot = world.robot();
  const Configurations path =
      read_configurations(waypoints, robot.chain().dof(), robot.description().label);
  if (path.is_one || path.columns.cols() < 2)
    throw std::invalid_argument("a path has at least two waypoints, (n, dof)");
  const py::gil_scoped_release unlocked;
  return world.prove(path.columns, clearance);
}

bool path_free_of(World& world, const Array& waypoints, double clearance) {
  return !proof_of(world, waypoints, clearance).refutation;
}

template <typename Member>
auto of_refutation(Member collision::EdgeRefutation::*member) {
  return [member](const PathProof& proof) {
    return proof.refutation ? std::optional((*proof.refutation).*member) : std::nullopt;
  };
}

void bind_path_proof(py::module_& module) {
  py::class_<PathProof>(module, "PathProof", "What World.prove() found of a path.")
      .def_property_readonly(
          "free", [](const PathProof& proof) { return !proof.refutation; },
          "Whether nothing touches on any line of the path, surely.")
      .def_readonly("edges", &PathProof::edges,
                    "Lines that are free, from the first on: the index of the one that is not.")
      .def_property_readonly(
          "q",
          [](const PathProof& proof) {
            return proof.refutation ? std::optional(to_vector(proof.refutation->q)) : std::nullopt;
          },
          "(dof,), where it is not free; None if it is.")
      .def_property_readonly("share", of_refutation(&collision::EdgeRefutation::share),
                             "Of that line before q, 0 to 1; None if it is free.")
      .def_property_readonly("first", of_refutation(&collision::EdgeRefutation::first),
                             "Name of what touches there, or is too near; None if it is free.")
      .def_property_readonly("second", of_refutation(&collision::EdgeRefutation::second),
                             "Name of the other; None if it is free.")
      .def_property_readonly("clearance", of_refutation(&collision::EdgeRefutation::clearance_m),
                             "Between the two, m; 0: they touch. None if it is free.")
      .def_property_readonly(
          "least_clearance",
          [](const PathProof& proof) {
            return std::isfinite(proof.least_clearance_m) ? std::optional(proof.least_clearance_m)
                                                          : std::nullopt;
          },
          "The least that was measured, m; None: nothing came so near that it had to be measured.");
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
  constexpr double kClearance_m = collision::EdgeProofOptions{}.clearance_m;
  bind_path_proof(module);
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
      .def("free", free_of, py::arg("q"), py::kw_only(), py::arg("clearance") = kClearance_m,
           "Whether configurations are free: a bool for (dof,), n of them for (n, dof). What comes "
           "nearer than the clearance, m, is not, as plan() has it; 0: only what touches. Limits "
           "are not checked.")
      .def("edge_free", edge_free_of, py::arg("from_q"), py::arg("to_q"), py::kw_only(),
           py::arg("clearance") = kClearance_m,
           "Whether the straight line between two configurations, (dof,) each, is proven to touch "
           "nothing. What comes nearer than the clearance, m, where it is looked at, counts as "
           "touching.")
      .def("path_free", path_free_of, py::arg("waypoints"), py::kw_only(),
           py::arg("clearance") = kClearance_m,
           "The same of all lines between the waypoints of a path, (n, dof).")
      .def("prove", proof_of, py::arg("waypoints"), py::kw_only(),
           py::arg("clearance") = kClearance_m,
           "The same, with where the path is not free, and what is too near there: a PathProof.")
      .def("contact", contact_of, py::arg("q"), py::kw_only(), py::arg("clearance") = kClearance_m,
           "Names of two things that touch at q, (dof,), or are nearer to each other than the "
           "clearance, m; None if none are. 0: only what touches.");
}

}  // namespace kinship::python
