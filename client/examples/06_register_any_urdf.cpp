// 06: Register any URDF, with a tool. A server needs the text of an arm's URDF, the ends of the
// chain, and the frame in the tool that all robots of a task place alike: z out of the palm, y
// along the closing fingers.
//
//   06_register_any_urdf URDF BASE TIP TOOL_LENGTH_M
#include <iostream>

#include "arms.hpp"

int main(int count, char** words) try {
  if (count != 5) {
    std::cerr << "usage: 06_register_any_urdf URDF BASE TIP TOOL_LENGTH_M\n";
    return 2;
  }
  kinship::RobotDescription arm;
  arm.label =
      "arm_with_tool";  // for people; another tool is another robot, with a label of its own
  arm.urdf = read_text(words[1]);
  arm.base_link = words[2];
  arm.tip_link = words[3];
  arm.T_tip_transfer.translation().z() = std::stod(words[4]);
  // Also, where needed: task_axes of a planar arm, held_joints off the chain, never_colliding pairs
  // of links.

  // A fault of a URDF is reported here, with link, joint, value and limit, before any request.
  const auto chain = kinship::kinematics::read_chain(arm).value_or_throw();
  for (const kinship::kinematics::Joint& joint : chain.joints())
    std::cout << joint.name << " from " << joint.lower << " to " << joint.upper << '\n';

  kinship::link::Client client(kinship::link::options_from_environment());
  const kinship::RegisterReply reply = client.register_robot(arm).value_or_throw();
  if (reply.status == kinship::RegisterStatus::Refused) {
    std::cerr << "refused: " << reply.message << '\n';
    return 1;
  }
  std::cout << "robot " << reply.robot.short_hex() << ", inverse kinematics: " << reply.solver
            << "\nthe server filters with: " << reply.geometry << '\n';
  return reply.robot == chain.digest() ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
