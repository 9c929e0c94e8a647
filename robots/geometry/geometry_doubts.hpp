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

/// Texts on missing or implausible geometry.
namespace kinship::geometry {

/// Origin of a link's solids.
enum class SolidsFrom { Nothing, VisualOnly, Collision, Visual };
const char* to_text(SolidsFrom from);  ///< "none", "none (visual only)", "collision", "visual"

/// The collision geometry of a link.
struct LinkExtent {
  std::string link;
  std::size_t solids = 0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< edges of the box along the link's axes
  double farthest_m = 0;  ///< from the link's origin to the farthest corner of that box
  SolidsFrom from = SolidsFrom::Nothing;
  bool moves = false;  ///< a joint of the chain moves it
};

/// One for each link, in the order of chain.links(). For a mesh its triangles count.
std::vector<LinkExtent> link_extents(const kinematics::Chain& chain, const RobotShapes& shapes);

/// Upper bound on the distance of the transfer frame from the base link's origin, m: the chain
/// stretched out.
double reach_m(const kinematics::Chain& chain);

/// A sentence, without a full stop, on each missing or implausibly large or small solid of a robot,
/// with advice.
std::vector<std::string> find_doubts(const kinematics::Chain& chain, const RobotShapes& shapes);

/// Why a robot cannot be planned for with collision checks: links that move and have visuals only.
std::optional<Error> find_missing_solids(const kinematics::Chain& chain, const RobotShapes& shapes);

/// A sentence on each object of a scene that no solid of the robot, nor an attached object, can
/// reach.
/// \param T_task_base  of the robot's base link.
std::vector<std::string> find_unreachable(const kinematics::Chain& chain, const RobotShapes& shapes,
                                          const Eigen::Isometry3d& T_task_base, const Scene& scene,
                                          const std::vector<AttachedObject>& attached);

}  // namespace kinship::geometry
