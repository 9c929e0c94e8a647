#include "client/python/robot.hpp"

#include <stdexcept>
#include <utility>

#include "robots/collision/fitted_links.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::python {
namespace {

constexpr const char* kTip = "tip";
constexpr const char* kTransfer = "transfer";

int index_of_link(const Robot& robot, const std::string& name) {
  const int link = robot.chain().find_link(name);
  if (link >= 0)
    return link;
  std::string known;
  for (const kinematics::ChainLink& other : robot.chain().links())
    known += ", " + other.name;
  throw Failure(ErrorCode::NotFound, "robot '" + robot.description().label + "' has no link '" +
                                         name + "'; frames: " + kTip + ", " + kTransfer + known);
}

}  // namespace

std::shared_ptr<Robot> Robot::load(const models::RobotArguments& arguments,
                                   std::vector<std::string>& warnings) {
  models::DescribedRobot described = models::describe_robot(arguments).value_or_throw();
  warnings = std::move(described.warnings);
  const std::optional<double> limit_slack = described.limit_slack;
  kinematics::RobotModel model = models::read_model(std::move(described)).value_or_throw();
  auto shapes = models::load_shapes(arguments, model);
  models::RobotArguments files = arguments;
  files.limit_slack = limit_slack;
  return std::make_shared<Robot>(std::move(model), std::move(shapes), std::move(files));
}

std::shared_ptr<Robot> Robot::of_description(RobotDescription description) {
  kinematics::RobotModel model = kinematics::read_model(std::move(description)).value_or_throw();
  auto shapes = geometry::read_shapes(model);
  return std::make_shared<Robot>(std::move(model), std::move(shapes));
}

Robot::Robot(kinematics::RobotModel model, Result<geometry::RobotShapes> shapes,
             std::optional<models::RobotArguments> files)
    : model_(std::move(model)),
      digest_(chain().digest()),
      shapes_(std::move(shapes)),
      files_(std::move(files)),
      solver_(chain()) {}

std::vector<Eigen::Isometry3d> Robot::poses(const Eigen::MatrixXd& qs,
                                            const std::string& frame) const {
  const bool is_tip = frame == kTip;
  const bool is_transfer = frame == kTransfer;
  const auto link =
      is_tip || is_transfer ? 0U : static_cast<std::size_t>(index_of_link(*this, frame));
  std::vector<Eigen::Isometry3d> T_base_frames;
  T_base_frames.reserve(static_cast<std::size_t>(qs.cols()));
  for (const auto& q : qs.colwise())
    T_base_frames.push_back(is_tip        ? kinematics::T_base_tip(chain(), q)
                            : is_transfer ? kinematics::T_base_transfer(chain(), q)
                                          : kinematics::link_poses(chain(), q)[link]);
  return T_base_frames;
}

Eigen::MatrixXd Robot::inverse(const Eigen::Isometry3d& T_base_frame, const std::string& frame,
                               const inverse::InverseOptions& options) const {
  if (frame != kTip && frame != kTransfer)
    throw std::invalid_argument("frame '" + frame + "', must be " + kTip + " or " + kTransfer);
  const Eigen::Isometry3d T_base_tip =
      frame == kTip ? T_base_frame : T_base_frame * chain().T_tip_transfer().inverse();
  return solver_.solve(T_base_tip, options).configurations;
}

std::shared_ptr<const guided::PlannedRobot> Robot::planned() const {
  if (!shapes_)
    throw Failure(shapes_.error());
  if (const auto error = geometry::find_faults(chain(), *shapes_))
    throw Failure(*error);
  const std::scoped_lock lock(mutex_);
  if (!planned_)
    planned_ = std::make_shared<const guided::PlannedRobot>(chain(), *shapes_);
  return planned_;
}

kinematics::RobotModel Robot::model_for_server() const {
  kinematics::RobotModel model = model_;
  if (!shapes_)
    return model;
  if (auto fitted = collision::fit_robot(model.chain, *shapes_))
    model.description.mesh_solids = std::move(fitted).value().mesh_solids;
  if (files_)  // else there are none; and a server needs none
    static_cast<void>(models::add_meshes(*files_, model));
  return model;
}

}  // namespace kinship::python
