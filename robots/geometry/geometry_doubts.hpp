#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/scene.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

/// Geometry that is missing or cannot be meant, in words.
namespace kinship::geometry {

/// Where the solids of a link come from.
enum class SolidsFrom { Nothing, VisualOnly, Collision, Visual };
const char* to_text(SolidsFrom from);  ///< "none", "none (visual only)", "collision", "visual"

/// What a collision checker sees of a link.
struct LinkExtent {
  std::string link;
  std::size_t solids = 0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< of the box along the link's axes
  double farthest_m = 0;  ///< from the link's origin to the farthest corner of that box
  SolidsFrom from = SolidsFrom::Nothing;
  bool moves = false;  ///< whether a joint of the chain moves it
};

/// One for each link, in the order of chain.links(). Of a mesh its triangles count.
std::vector<LinkExtent> link_extents(const kinematics::Chain& chain, const RobotShapes& shapes);

/// How far from the base link's origin the transfer frame can get at most, m: a bound, the chain
/// stretched out.
double reach_m(const kinematics::Chain& chain);

/// What is missing among a robot's solids, or so large or small that it cannot be meant, with what
/// to do; a sentence each, without a full stop at its end.
std::vector<std::string> find_doubts(const kinematics::Chain& chain, const RobotShapes& shapes);

/// Why a robot cannot be planned for with collision checks: links that move and have visuals only.
std::optional<Error> find_missing_solids(const kinematics::Chain& chain, const RobotShapes& shapes);

/// What of a scene lies so far away that no solid of the robot, nor anything attached to it, can
/// touch it; a sentence each.
/// \param T_task_base  of the robot's base link.
std::vector<std::string> find_unreachable(const kinematics::Chain& chain, const RobotShapes& shapes,
                                          const Eigen::Isometry3d& T_task_base, const Scene& scene,
                                          const std::vector<AttachedObject>& attached);

}  // namespace kinship::geometry
