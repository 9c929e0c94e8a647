#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "client/python/errors.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"

namespace kinship::python {
namespace {

using RobotClass = py::class_<Robot, std::shared_ptr<Robot>>;

std::string words_of(const Eigen::Isometry3d& T) {
  std::string words;
  for (const double number : to_pose_array(T))
    words += (words.empty() ? "" : " ") + number_text(number);
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ",") + word;
  return text;
}

template <typename Value, typename ToText>
std::vector<std::string> pairs_of(const std::map<std::string, Value>& values, ToText to_text) {
  std::vector<std::string> pairs;
  for (const auto& [name, value] : values)
    pairs.push_back(name + "=" + to_text(value));
  return pairs;
}

std::vector<std::string> joint_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const kinematics::Joint& joint : robot.chain().joints())
    names.push_back(joint.name);
  return names;
}

std::vector<std::string> link_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const kinematics::ChainLink& link : robot.chain().links())
    names.push_back(link.name);
  return names;
}

Array forward(const Robot& robot, const Array& q, const std::string& frame) {
  const Configurations configurations =
      read_configurations(q, robot.chain().dof(), robot.description().label);
  std::vector<Eigen::Isometry3d> poses;
  {
    const py::gil_scoped_release unlocked;
    poses = robot.poses(configurations.columns, frame);
  }
  if (configurations.is_one)
    return to_matrix(poses.front());
  constexpr Eigen::Index kRows = 4;
  Array matrices({static_cast<py::ssize_t>(poses.size()), kRows, kRows});
  double* next = matrices.mutable_data();
  for (const Eigen::Isometry3d& pose : poses) {
    Eigen::Map<Eigen::Matrix4d>{next} = pose.matrix().transpose();
    next += kRows * kRows;
  }
  return matrices;
}

void bind_loading(RobotClass& robot) {
  robot.def(
      py::init([](const std::filesystem::path& source, const std::string& base,
                  const std::string& tip, const std::string& label,
                  const std::optional<Array>& transfer, const std::vector<std::string>& axes,
                  const std::map<std::string, double>& held,
                  const std::optional<std::filesystem::path>& srdf,
                  const std::map<std::string, std::string>& packages, bool collision_from_visual,
                  const std::vector<std::string>& without_collision,
                  const std::map<std::string, std::string>& xacro, bool without_meshes) {
        models::RobotArguments arguments{
            .source = source,
            .base_link = base,
            .tip_link = tip,
            .label = label,
            .transfer = {},
            .axes = joined(axes),
            .held = pairs_of(held, number_text),
            .srdf = srdf.value_or(std::filesystem::path()),
            .packages = pairs_of(packages, [](const auto& folder) { return folder; }),
            .collision_from_visual = collision_from_visual,
            .without_meshes = without_meshes,
            .without_collision = without_collision};
        for (const auto& [name, value] : xacro)
          arguments.xacro.push_back(name + ":=" + value);
        if (transfer)
          arguments.transfer = words_of(read_pose(*transfer, "transfer"));
        std::vector<std::string> warnings;
        std::shared_ptr<Robot> read;
        {
          const py::gil_scoped_release unlocked;
          read = Robot::load(arguments, warnings);
        }
        std::ranges::for_each(warnings, [](const auto& each) { warn("InputChanged", each); });
        return read;
      }),
      R"(Reads a robot.

source    a model folder (chain.toml, robot.urdf) or a URDF file
base, tip names of links; required for a URDF file
label     what people call it; by default the folder's, or the file's name
transfer  pose of the transfer frame in the tip link: 4 x 4, or x y z qx qy qz qw
axes      those of x y z roll pitch yaw that matter; by default the folder's, or all
held      positions of joints off the chain
srdf      its disabled pairs of links are never checked
packages  folders of the packages that meshes are in, by name; others are searched as ROS does
collision_from_visual  links that are drawn and have no solids: what is drawn is solid
without_collision      names of links that are drawn and need no solid
xacro     arguments of a URDF or SRDF that is xacro, which the program xacro expands
without_meshes         the meshes stay here: a server gets solids around them alone

Raises NotFound, InvalidInput or TooLarge with the file and the value.)",
      py::arg("source"), py::kw_only(), py::arg("base") = "", py::arg("tip") = "",
      py::arg("label") = "", py::arg("transfer") = py::none(),
      py::arg("axes") = std::vector<std::string>(),
      py::arg("held") = std::map<std::string, double>(), py::arg("srdf") = py::none(),
      py::arg("packages") = std::map<std::string, std::string>(),
      py::arg("collision_from_visual") = false,
      py::arg("without_collision") = std::vector<std::string>(),
      py::arg("xacro") = std::map<std::string, std::string>(), py::arg("without_meshes") = false);
}

void bind_properties(RobotClass& robot) {
  robot
      .def_property_readonly(
          "label", [](const Robot& self) { return self.description().label; },
          "What people call it.")
      .def_property_readonly(
          "digest", [](const Robot& self) { return self.digest().hex(); },
          "Its identity, of its kinematics alone: 64 hexadecimal digits.")
      .def_property_readonly(
          "dof", [](const Robot& self) { return self.chain().dof(); }, "Number of joints.")
      .def_property_readonly("joint_names", joint_names, "From base to tip.")
      .def_property_readonly("link_names", link_names, "Every link of the URDF.")
      .def_property_readonly(
          "lower", [](const Robot& self) { return to_vector(self.chain().lower()); },
          "Lower joint limits: (dof,), rad or m; -pi for continuous joints.")
      .def_property_readonly(
          "upper", [](const Robot& self) { return to_vector(self.chain().upper()); },
          "Upper joint limits: (dof,), rad or m; pi for continuous joints.")
      .def_property_readonly(
          "T_tip_transfer",
          [](const Robot& self) { return to_matrix(self.chain().T_tip_transfer()); },
          "Pose of the transfer frame in the tip link: (4, 4).")
      .def_property_readonly(
          "solver", [](const Robot& self) { return self.solver().name(); },
          "What inverse kinematics uses for it, in words.");
}

}  // namespace

void bind_robots(py::module_& module) {
  RobotClass robot(module, "Robot",
                   "A robot: its chain from base to tip, its transfer frame and its collision "
                   "geometry. May be shared between threads.");
  bind_loading(robot);
  bind_properties(robot);
  robot
      .def("fk", forward, py::arg("q"), py::arg("frame") = "tip",
           R"(Pose of a frame in the base link, m.

q      (dof,) or (n, dof), joint units; limits are not checked
frame  "tip", "transfer" or the name of a link

Returns (4, 4) or (n, 4, 4).)")
      .def(
          "ik",
          [](const Robot& self, const Array& pose, const std::string& frame, int max_solutions,
             double min_distance, std::uint64_t seed) {
            const Eigen::Isometry3d T_base_frame = read_pose(pose, "pose");
            Eigen::MatrixXd solutions;
            {
              const py::gil_scoped_release unlocked;
              solutions = self.inverse(
                  T_base_frame, frame,
                  {.max_solutions = max_solutions, .min_distance = min_distance, .seed = seed});
            }
            return to_rows(solutions);
          },
          py::arg("pose"), py::kw_only(), py::arg("frame") = "tip", py::arg("max_solutions") = 8,
          py::arg("min_distance") = 0.2, py::arg("seed") = 0,
          R"(Distinct configurations within the limits that put a frame at a pose in the base link.

pose           (4, 4), or (7,): x y z qx qy qz qw
frame          "tip" or "transfer"
max_solutions  0: all that are found
min_distance   between two of them, 1 m = 1 rad

Returns (n, dof); n is 0 for a pose that cannot be reached. Equal seed, equal solutions.)")
      .def("__repr__", [](const Robot& self) {
        return "<kinship.Robot '" + self.description().label + "', " +
               std::to_string(self.chain().dof()) + " joints, " + self.digest().short_hex() + ">";
      });
}

}  // namespace kinship::python
