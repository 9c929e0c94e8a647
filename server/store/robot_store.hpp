#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/page.hpp"

namespace kinship::store {

/// A robot as stored. Its digest and dof were computed by the caller.
struct RobotRecord {
  Digest digest;
  RobotDescription description;
  std::uint32_t dof = 0;
  std::int64_t registered_ms = 0;
  std::uint64_t geometry_revision = 0;  ///< how often better geometry replaced it
  std::int64_t geometry_ms = 0;         ///< last replacement; 0: never
};

/// A removed robot, and its experience and distributions.
struct RemovedRobot {
  RobotRemoval removal;
  std::vector<std::string> tasks;     ///< of its attempts and distributions
  std::vector<Digest> distributions;  ///< of the robot, which are gone
};

/// What became of contents of meshes.
struct MeshesPut {
  std::size_t stored = 0;   ///< new
  std::size_t over = 0;     ///< beyond the size of all
  std::size_t refused = 0;  ///< that are none, or that the robot does not name
  std::string why;          ///< the last was refused
  /// With these, all meshes of the robot for collision are here: its geometry_revision rose.
  bool is_complete = false;
};

struct MeshLimits {
  std::uint64_t max_bytes = 0;  ///< of all contents, compressed
  std::int64_t now_ms = 0;      ///< Unix time, UTC
};

/// Contents of meshes in a store.
struct MeshUse {
  std::uint64_t count = 0;
  std::uint64_t bytes = 0;  ///< compressed
};

/// Keeps the registered robots; see Store.
class RobotStore {
 public:
  /// Durable on return. Known: the digest is registered already (its label and text stay). A
  /// damaged row of this digest is written anew from `robot` and keeps its paths: Registered.
  /// \return Conflict if another robot has the label; InvalidInput if a value cannot be kept.
  virtual Result<RegisterStatus> register_robot(const RobotRecord& robot) = 0;
  /// Replaces a known robot's description by one with better geometry; its label and registration
  /// time stay. Durable on return.
  /// \param robot  its geometry_revision is one more than the stored one.
  /// \return false, and nothing changes, if it is not, as after another call; or if the row is
  ///         damaged or missing.
  virtual bool replace_geometry(const RobotRecord& robot) = 0;
  /// Gives a robot another label, durable on return; the old label is free from then on. A client
  /// that registers the robot under the old label is answered Known.
  /// \return NotFound for an unknown robot; Conflict if another robot has the label; InvalidInput
  ///         if `label` is none.
  virtual Result<bool> rename_robot(const Digest& robot, const std::string& label,
                                    const AuditEntry* audit = nullptr) = 0;
  /// Removes a robot, durable on return: its label is free, it is neither found nor listed, its
  /// distributions are deleted and its paths retired. A robot without attempts is deleted.
  /// Otherwise its attempts, paths and UUIDs stay for the record; a new registration is answered
  /// Registered, with its own label, and new reports count; retired paths stay retired.
  ///
  /// The last transaction makes the removal. Before it, paths beyond some hundreds are retired in
  /// transactions of their own; a stop or failure between two of them leaves a robot with fewer
  /// paths.
  /// \param stop  checked between transactions.
  /// \return NotFound for an unknown robot; Unavailable if it was stopped.
  virtual Result<RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop = {},
                                            const AuditEntry* audit = nullptr) = 0;
  /// By robot; only robots whose geometry was ever replaced.
  virtual std::map<Digest, std::uint64_t> geometry_revisions() const = 0;
  virtual std::optional<RobotRecord> find_robot(const Digest& robot) const = 0;
  /// Keeps contents of meshes that a registered robot names, each once for all robots. Durable on
  /// return. A content goes when no registered robot names it any more.
  virtual MeshesPut put_meshes(const Digest& robot, const std::vector<MeshContent>& contents,
                               const MeshLimits& limits) = 0;
  /// Nothing also if it is damaged.
  virtual std::optional<MeshContent> find_mesh(const Digest& content) const = 0;
  /// Compressed bytes of those of the contents that are there.
  virtual std::map<Digest, std::uint64_t> known_meshes(const std::set<Digest>& contents) const = 0;
  virtual MeshUse mesh_use() const = 0;
  /// In order of labels. A robot with a damaged row is left out and counted in
  /// AdminStore::status().message; find_robot() throws for it.
  virtual std::vector<RobotRecord> robots() const = 0;
  /// `solver` is left empty.
  virtual Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const = 0;
  /// Whether other servers may have the store open, too: then a call may wait for another machine,
  /// and Store::changes_since() reports the changes of the others.
  virtual bool is_shared() const { return false; }

 protected:
  ~RobotStore() = default;
};

}  // namespace kinship::store
