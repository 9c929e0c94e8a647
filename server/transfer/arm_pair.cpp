#include "server/transfer/arm_pair.hpp"

#include <utility>

namespace kinship::transfer {
namespace {

constexpr double kSamePlacement = 1e-9;  // m and rad

}  // namespace

ArmPair::ArmPair(const kinematics::Chain& source, std::shared_ptr<const TargetArm> target)
    : source_(source),
      target_(std::move(target)),
      likeness_(kinematics::compare_arms(source, target_->chain())) {}

ArmPair::ArmPair(const kinematics::Chain& source, const kinematics::Chain& target)
    : ArmPair(source, std::make_shared<const TargetArm>(target)) {}

bool ArmPair::takes_over(const Eigen::Isometry3d& T_target_source) const {
  const double difference =
      (T_target_source.matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff();
  return likeness_ != kinematics::ArmLikeness::Different && difference <= kSamePlacement;
}

}  // namespace kinship::transfer
