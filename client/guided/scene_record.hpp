#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/problem.hpp"
#include "proto/types/recorded_scene.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::guided {

/// Makes the records of problem scenes that reports carry. Solids around a mesh are fitted once,
/// however many problems share it. Used by one thread.
class SceneRecords {
 public:
  using NamePairs = std::vector<std::pair<std::string, std::string>>;

  /// A problem's scene and constraint without its robot. Objects attached to the tip link, or to a
  /// link fixed to it, are given in the transfer frame; objects of other links, and allowed pairs
  /// that name a link, are left out: another robot has no such link. A mesh becomes solids around
  /// it, which have its name and are marked as approximate; a point cloud becomes boxes likewise.
  /// \param problem  its meshes and clouds have been read.
  /// \return Error that names the rule which the scene breaks: too large, an empty name.
  Result<RecordedScene> record(const kinematics::Chain& chain, const Problem& problem);
  /// The same of a scene without a constraint.
  /// \param held  given in the transfer frame, whatever link they name.
  Result<RecordedScene> record(const Scene& scene, const std::vector<AttachedObject>& held,
                               const NamePairs& allowed_collisions);

 private:
  using Solids = std::shared_ptr<const std::vector<geometry::FittedShape>>;

  Result<Solids> around(const Mesh& mesh, const std::string& name);
  std::optional<Error> add_held(const AttachedObject& held, RecordedScene& scene);

  std::map<std::shared_ptr<const Eigen::Matrix3Xd>, Solids> solids_;  // by the mesh's triangles
};

/// The same for one problem alone.
Result<RecordedScene> record_scene(const kinematics::Chain& chain, const Problem& problem);

}  // namespace kinship::guided
