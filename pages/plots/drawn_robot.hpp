#pragma once

#include <map>
#include <string>
#include <vector>

#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::plots {

/// A robot as far as its description shows it, with the contents of its meshes that are here.
struct DrawnRobot {
  models::LoadedRobot robot;               ///< with the shapes that filters know
  geometry::RobotShapes solids;            ///< without meshes: those around them
  std::map<Digest, std::string> contents;  ///< of meshes: canonical bytes in base64
  std::string shapes;                      ///< text on the known shapes
};

/// \param contents  of its meshes, those that are here.
/// \throws Failure as kinematics::read_model and geometry::read_known_shapes.
DrawnRobot drawn_robot(const RobotDescription& description,
                       const std::vector<StoredMesh>& contents = {});

/// The chain, for forward kinematics in chain.js, the solids of each link in its frame, and the
/// meshes: {"link", "role", "pose", "rgba", "error_m", "content"}, with `contents`: their canonical
/// bytes (FORMATS.md) in base64, by digest. Poses in m, solids as pages/page/json_text.hpp writes
/// them.
std::string to_json(const DrawnRobot& drawn);

}  // namespace kinship::plots
