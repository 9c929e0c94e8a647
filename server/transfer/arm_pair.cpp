#include "server/transfer/arm_pair.hpp"

#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {
namespace {

constexpr double kSamePlacement = 1e-9;  // m and rad

}  // namespace

ArmPair::ArmPair(const kinematics::Chain& source, const kinematics::Chain& target)
    : source_(source),
      target_(target),
      likeness_(kinematics::compare_arms(source, target)),
      target_descent_(target),
      target_solver_(target),
      target_marks_(shape_marks(target)) {}

bool ArmPair::takes_over(const Eigen::Isometry3d& T_target_source) const {
  const double difference =
      (T_target_source.matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff();
  return likeness_ != kinematics::ArmLikeness::Different && difference <= kSamePlacement;
}

}  // namespace kinship::transfer
