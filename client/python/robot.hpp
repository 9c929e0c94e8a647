#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "client/guided/plan_problem.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::python {

/// A robot with its derived values, computed once. Immutable to its users, shared between threads.
class Robot {
 public:
  /// Loads a robot with its collision meshes, or with the reason why they cannot be read:
  /// kinematics and the server need none.
  /// \throws Failure as models::describe_robot and kinematics::read_model.
  /// \param warnings  of models::describe_robot().
  static std::shared_ptr<Robot> load(const models::RobotArguments& arguments,
                                     std::vector<std::string>& warnings);

  /// A robot of a server's or file's description, which has no files: its meshes are not known.
  static std::shared_ptr<Robot> of_description(RobotDescription description);

  /// \param files  of the robot, with its meshes for a server.
  Robot(kinematics::RobotModel model, Result<geometry::RobotShapes> shapes,
        std::optional<models::RobotArguments> files = {});

  const RobotDescription& description() const noexcept { return model_.description; }
  const kinematics::Chain& chain() const noexcept { return model_.chain; }
  const Digest& digest() const noexcept { return digest_; }
  const inverse::Solver& solver() const noexcept { return solver_; }

  /// Pose of a frame in the base link: "tip", "transfer" or a link.
  /// \param qs  dof x n.
  /// \throws Failure(NotFound) if there is no such link.
  std::vector<Eigen::Isometry3d> poses(const Eigen::MatrixXd& qs, const std::string& frame) const;

  /// \param frame  "tip" or "transfer".
  /// \return       dof x n, n >= 0.
  /// \throws std::invalid_argument for another frame.
  Eigen::MatrixXd inverse(const Eigen::Isometry3d& T_base_frame, const std::string& frame,
                          const inverse::InverseOptions& options) const;

  /// The robot as shared by planning and its worlds; made at the first call.
  /// \throws Failure if its collision geometry is unknown.
  std::shared_ptr<const guided::PlannedRobot> planned() const;

  /// Its collision geometry; to be called after planned(), which checks that it is known.
  const geometry::RobotShapes& shapes() const { return shapes_.value(); }

  /// Whether its meshes are to stay here.
  bool keeps_meshes() const { return files_ && files_->without_meshes; }
  /// How far a start or goal may be beyond a limit, joint units, if the robot's files say so.
  std::optional<double> limit_slack() const { return files_ ? files_->limit_slack : std::nullopt; }

  /// The robot with its known meshes and solids around them, if any, in its description.
  kinematics::RobotModel model_for_server() const;

 private:
  kinematics::RobotModel model_;
  Digest digest_;
  Result<geometry::RobotShapes> shapes_;
  std::optional<models::RobotArguments> files_;
  inverse::Solver solver_;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::shared_ptr<const guided::PlannedRobot> planned_;
};

}  // namespace kinship::python
