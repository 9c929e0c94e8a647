#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>

namespace kinship::moveit {

/// A scene in the text form that RViz exports as `.scene`, as a moveit_msgs/PlanningScene: its
/// name, and objects in the planning frame. Colours and subframes are left out.
///
/// A line `* ID` begins an object: its pose, number of shapes, shapes, number of subframes and
/// subframes; before MoveIt 1.1 it has neither pose nor subframes. A line `.` ends the scene.
/// Source: MoveIt, planning_scene::PlanningScene::saveGeometryToStream, loadGeometryFromStream;
/// geometric_shapes, shapes::saveAsText.
/// \return empty for a file in another form: not called `.scene`, and without `*` or `.` in its
///         second line.
/// \throws Failure(NotFound or InvalidInput) that names file and line; also for a cone, a plane or
///         an octree, which a problem cannot express.
std::optional<YAML::Node> read_scene_text(const std::filesystem::path& file);

}  // namespace kinship::moveit
