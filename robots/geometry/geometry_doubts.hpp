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

/// Upper bound on the distance of the tip link's origin from the base link's, m: the chain
/// stretched out.
double reach_m(const kinematics::Chain& chain);

/// Distance of the transfer frame from the tip link's origin, m.
double transfer_distance_m(const kinematics::Chain& chain);

/// A sentence, without a full stop, on each missing or implausibly large or small solid of a robot,
/// and on an implausible reach or transfer frame, with advice.
std::vector<std::string> find_doubts(const kinematics::Chain& chain, const RobotShapes& shapes);

/// Why a chain cannot be meant: its reach without rails is above 200 m, or its transfer frame is
/// farther from the tip link than 10 times the reach (of at least 0.5 m). The message says whether
/// these are probably millimetres.
std::optional<Error> find_impossible_lengths(const kinematics::Chain& chain);

/// Why a robot cannot be planned for with collision checks: links that move and have visuals only.
std::optional<Error> find_missing_solids(const kinematics::Chain& chain, const RobotShapes& shapes);

/// Why solids cannot be meant: a moving link sticks out farther from its origin than 50 times the
/// reach.
std::optional<Error> find_impossible_solids(const kinematics::Chain& chain,
                                            const RobotShapes& shapes);

/// Why a robot is not planned for: the first of find_missing_solids, find_impossible_solids.
std::optional<Error> find_faults(const kinematics::Chain& chain, const RobotShapes& shapes);

/// That a place is more than 10 times out of reach, with its distance: "it is 420 m away from the
/// robot's base, which gets 1.1 m far; these are probably millimetres (0.42 m)"; empty of a nearer
/// one.
/// \param p_base_place  where the transfer frame is wanted, in the base link, m.
std::string describe_far_place(const kinematics::Chain& chain, const Eigen::Vector3d& p_base_place);

/// A sentence on each object of a scene that no solid of the robot, nor an attached object, can
/// reach, or that is more than 100 times as long as the robot reaches.
/// \param T_task_base  of the robot's base link.
std::vector<std::string> find_scene_doubts(const kinematics::Chain& chain,
                                           const RobotShapes& shapes,
                                           const Eigen::Isometry3d& T_task_base, const Scene& scene,
                                           const std::vector<AttachedObject>& attached);

}  // namespace kinship::geometry
