#pragma once

#include "proto/types/problem.hpp"
#include "proto/types/recorded_scene.hpp"
#include "proto/types/result.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::planner {

/// A problem's scene and constraint without its robot, as the server is told of them. What is
/// attached to the tip, or to a link that is fixed to it, is said in the transfer frame; what
/// another link carries, and allowed pairs that name a link, are left out: another robot has no
/// such link.
/// \return Error that names the mesh, or the rule which the scene breaks: too large, an empty name.
Result<RecordedScene> record_scene(const kinematics::Chain& chain, const Problem& problem);

}  // namespace kinship::planner
