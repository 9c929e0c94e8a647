#include "robots/models/loaded_robot.hpp"

#include <algorithm>
#include <utility>

#include "robots/geometry/geometry_doubts.hpp"

namespace kinship::models {
namespace {

/// Takes the links that need no solid from the links whose solids are missed.
std::optional<Error> excuse(const std::vector<std::string>& links, const kinematics::Chain& chain,
                            geometry::RobotShapes& shapes) {
  for (const std::string& link : links) {
    const int index = chain.find_link(link);
    if (index < 0)
      return invalid_input("--without-collision '" + link + "': the robot has no such link");
    if (std::ranges::find(shapes.shapes, index, &geometry::LinkShape::link) != shapes.shapes.end())
      return invalid_input("--without-collision '" + link +
                           "': the link has solids, and these are checked; it is for links that "
                           "have none");
    std::erase(shapes.visual_only, index);
  }
  return std::nullopt;
}

/// The files that a robot's URDF names.
/// \param arguments  resolved.
Result<MeshFiles> files_of(const RobotArguments& arguments) {
  auto packages = parse_packages(arguments.packages);
  if (!packages)
    return packages.error();
  return MeshFiles(arguments.source.parent_path(), *std::move(packages), arguments.mesh_folders);
}

}  // namespace

Result<geometry::RobotShapes> load_shapes(const RobotArguments& arguments,
                                          const kinematics::RobotModel& robot) {
  const auto resolved = resolve(arguments);
  if (!resolved)
    return resolved.error();
  const auto files = files_of(resolved->arguments);
  if (!files)
    return files.error();
  auto read =
      geometry::read_shapes(robot, [&](const std::string& uri) { return files->read(uri); });
  if (!read)
    return read.error();
  geometry::RobotShapes shapes = *std::move(read);
  if (const auto error = excuse(resolved->arguments.without_collision, robot.chain, shapes))
    return *error;
  return shapes;
}

Result<PackageFolders> packages_of(const RobotArguments& arguments) {
  const auto resolved = resolve(arguments);
  if (!resolved)
    return resolved.error();
  return parse_packages(resolved->arguments.packages);
}

Result<std::vector<std::string>> add_meshes(const RobotArguments& arguments,
                                            kinematics::RobotModel& robot) {
  if (arguments.without_meshes)
    return std::vector<std::string>();
  const auto resolved = resolve(arguments);
  if (!resolved)
    return resolved.error();
  const auto files = files_of(resolved->arguments);
  if (!files)
    return files.error();
  geometry::LinkMeshes read =
      geometry::read_link_meshes(robot, [&](const std::string& uri) { return files->read(uri); });
  robot.description.meshes = std::move(read.meshes);
  robot.description.contents = std::move(read.contents);
  return std::move(read.notes);
}

Result<LoadedRobot> load_robot(const RobotArguments& arguments) {
  auto described = describe_robot(arguments);
  if (!described)
    return described.error();
  std::vector<std::string> warnings = described->warnings;
  const std::optional<double> limit_slack = described->limit_slack;
  auto robot = read_model(std::move(described).value());
  if (!robot)
    return robot.error();
  auto shapes = load_shapes(arguments, *robot);
  if (!shapes)
    return shapes.error();
  if (const auto error = geometry::find_faults(robot->chain, *shapes))
    return *error;
  return LoadedRobot{*std::move(robot), *std::move(shapes), std::move(warnings), limit_slack};
}

}  // namespace kinship::models
