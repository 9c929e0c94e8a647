#include "client/cli/robot_geometry.hpp"

#include <ostream>

#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::cli {

void note_missing_geometry(const char* command, const models::RobotArguments& arguments,
                           const RobotDescription& description, std::ostream& err) {
  const auto chain = kinematics::read_chain(description);
  if (!chain)
    return;
  const auto shapes = models::load_shapes(arguments, description, *chain);
  if (!shapes)
    err << command << ": without collision geometry: " << shapes.error().message << '\n';
}

}  // namespace kinship::cli
