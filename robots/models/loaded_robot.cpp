#include "robots/models/loaded_robot.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include "robots/kinematics/urdf.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::models {

Result<geometry::RobotShapes> load_shapes(const RobotArguments& arguments,
                                          const RobotDescription& description,
                                          const kinematics::Chain& chain) {
  auto packages = parse_packages(arguments.packages);
  if (!packages)
    return packages.error();
  std::error_code unreadable;
  const bool is_folder = std::filesystem::is_directory(arguments.source, unreadable);
  const MeshFiles files(is_folder ? arguments.source : arguments.source.parent_path(),
                        *std::move(packages));
  return geometry::read_shapes(description, chain,
                               [&](const std::string& uri) { return files.read(uri); });
}

Result<LoadedRobot> load_robot(const RobotArguments& arguments) {
  auto description = describe_robot(arguments);
  if (!description)
    return description.error();
  auto chain = kinematics::read_chain(*description);
  if (!chain)
    return chain.error();
  auto shapes = load_shapes(arguments, *description, *chain);
  if (!shapes)
    return shapes.error();
  return LoadedRobot{*std::move(description), *std::move(chain), *std::move(shapes)};
}

}  // namespace kinship::models
