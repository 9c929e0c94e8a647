#pragma once

#include <functional>
#include <optional>

#include "proto/types/conversations.hpp"
#include "proto/types/link_mesh.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::link {

/// Registers a robot once, for a bounded time.
using RegisterOnce = std::function<Result<RegisterReply>(const RobotDescription&)>;

/// Gives the content of a mesh; nothing: it is not here.
using FindContent = std::function<std::optional<MeshContent>(const Digest& content)>;

/// Registers a robot, and again with contents of its meshes as long as the server wants some that
/// are here and takes them: as many a message as it holds. A server that knows of no meshes wants
/// none.
/// \return the reply to the first request if that is no success, else the last one, which says
///         `registered` and `took_geometry` if any did; `wanted` names what is not there yet.
Result<RegisterReply> register_with_meshes(RobotDescription description, const FindContent& find,
                                           const RegisterOnce& register_once);

}  // namespace kinship::link
