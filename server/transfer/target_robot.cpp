#include "server/transfer/target_robot.hpp"

#include <utility>

#include "server/transfer/arm_shape.hpp"

namespace kinship::transfer {

TargetArm::TargetArm(kinematics::Chain chain)
    : chain_(std::move(chain)), descent_(chain_), solver_(chain_), marks_(shape_marks(chain_)) {}

TargetRobot::TargetRobot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes)
    : arm(std::make_shared<const TargetArm>(chain)), solids(chain, shapes) {}

}  // namespace kinship::transfer
