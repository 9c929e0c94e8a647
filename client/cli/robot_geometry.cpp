#include "client/cli/robot_geometry.hpp"

#include <ostream>

#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::cli {

std::optional<geometry::RobotShapes> read_geometry(const char* command,
                                                   const models::RobotArguments& arguments,
                                                   const RobotDescription& description,
                                                   std::ostream& err) {
  const auto chain = kinematics::read_chain(description);
  if (!chain)
    return std::nullopt;
  auto shapes = models::load_shapes(arguments, description, *chain);
  if (shapes)
    return *std::move(shapes);
  err << command << ": without collision geometry: " << shapes.error().message << '\n';
  return std::nullopt;
}

}  // namespace kinship::cli
