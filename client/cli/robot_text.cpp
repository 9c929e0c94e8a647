#include "client/cli/robot_text.hpp"

#include <ostream>

#include "client/cli/cell_text.hpp"

namespace kinship::cli {

std::string axes_text(const TaskAxes& axes) {
  if (axes.all())
    return "all";
  std::string text;
  for (std::size_t i = 0; i < kTaskAxisNames.size(); ++i)
    if (axes.matters[i])
      text += (text.empty() ? "" : " ") + std::string(kTaskAxisNames[i]);
  return text;
}

void print_transfer(const RobotDescription& description, std::ostream& out) {
  constexpr int kDigits = 4;
  out << "transfer    " << pose_text(description.T_tip_transfer) << " in " << description.tip_link
      << '\n'
      << "axes        " << axes_text(description.task_axes) << '\n';
  if (description.held_joints.empty())
    return;
  std::string held;
  for (const auto& [joint, value] : description.held_joints)
    held += (held.empty() ? "" : ", ") + joint + " = " + number_text(value, kDigits);
  out << "held        " << held << '\n';
}

}  // namespace kinship::cli
