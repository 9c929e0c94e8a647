#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"
#include "server/store/robot_store.hpp"

namespace kinship::runtime {

/// A robot that the service can compute with.
struct Robot {
  Digest digest;
  std::string label;
  kinematics::Chain chain;
  /// For the URDF's meshes, the solids that a client fitted around them, if any; empty if the
  /// geometry cannot be read.
  geometry::RobotShapes shapes = {};
  /// Around the meshes of `shapes`: geometry::KnownShapes::covers.
  std::shared_ptr<const geometry::RobotShapes> covers = nullptr;
  GeometryGrade grade = GeometryGrade::None;
  std::string geometry = {};             ///< description of the shapes
  std::uint64_t geometry_revision = 0;   ///< number of times better geometry was taken over
  std::vector<LinkMesh> meshes = {};     ///< of the URDF, by their contents
  std::set<Digest> missing_meshes = {};  ///< contents of these that the store lacks
  std::uint64_t mesh_bytes = 0;          ///< of those it has, compressed
};

/// What of a robot's meshes is here, e.g. "20 meshes, 8 of them for collision; 18 of 18 contents
/// are here, 1 234 bytes compressed".
std::string describe_meshes(const Robot& robot);

/// A robot that asks to be registered: its description, read once, or why it is none.
class Candidate {
 public:
  Candidate(RobotDescription description)  // NOLINT(google-explicit-constructor): reads it
      : robot_(kinematics::read_model(std::move(description))) {}

  /// The robot, or the error of kinematics::read_model().
  const Result<kinematics::RobotModel>& robot() const noexcept { return robot_; }

 private:
  Result<kinematics::RobotModel> robot_;
};

/// The robots of a store, with a cache of the most recently used, parsed. May be shared between
/// threads; no lock is held while it parses or reads the store.
class RobotRegistry {
 public:
  /// Shared by the registry and the users of the robot: it never changes.
  using RobotPointer = std::shared_ptr<const Robot>;

  /// Why the caller may not use a robot of this label; nothing if it may.
  using LabelRule = std::function<std::optional<Error>(const std::string& label)>;

  struct Options {
    std::size_t max_robots = 1024;  ///< in memory; the least recently used is dropped first
    /// Of contents of meshes in the store, compressed; 0: none are taken.
    std::uint64_t max_mesh_bytes = std::uint64_t{256} << 20U;
    /// Called if a stored robot cannot be read, with its name and the reason. Called from any
    /// thread.
    std::function<void(const std::string& message)> on_unreadable = [](const std::string&) {};
  };

  /// Whether other servers may register robots in the store, too.
  bool is_shared() const { return store_.is_shared(); }

  /// \param store  outlives the registry.
  explicit RobotRegistry(store::RobotStore& store) : RobotRegistry(store, Options{}) {}
  RobotRegistry(store::RobotStore& store, Options options);

  /// Identifies and stores a robot, and lists other robots of the store that are the same
  /// arm: at most kMaxSameArms labels, in their order, fewer if the store cannot be read. Refused,
  /// with the reason, if the description breaks a rule or its label belongs to another robot; for
  /// now, if `may_take` has to judge a label that a damaged row does not give.
  ///
  /// The description replaces a known robot's, except the label, if its geometry is better: exact
  /// shapes (primitives, or meshes whose contents are all here) before solids around meshes before
  /// those of some links only before none; then the one that names more meshes; of equals the first
  /// stays. Contents that come with it are stored, up to Options::max_mesh_bytes; the reply names
  /// those of its meshes that are still missing.
  ///
  /// It is compared with the first kMaxSameArms robots of as many joints; those not in memory are
  /// read.
  ///
  /// If other servers share the store, a robot in memory is known without reading the store, and
  /// compared with robots in memory: it is answered even while the store cannot be reached.
  /// \param now_ms    Unix time, UTC.
  /// \param may_take  called with the label under which the robot is known, before any of its data
  ///                  is changed or returned; empty: every caller may register a known robot.
  /// \throws Failure(Storage), also if that label cannot be read now.
  RegisterReply register_robot(const Candidate& candidate, std::int64_t now_ms,
                               const LabelRule& may_take = {});

  /// The same from memory, without the store: if other servers share the store, for a robot in
  /// memory if the new geometry is not better than the known one, and for registrations that are
  /// refused whatever the store has. \return nothing if register_robot() has to be called.
  std::optional<RegisterReply> register_known(const Candidate& candidate,
                                              const LabelRule& may_take = {}) const;

  /// Takes over geometry of a known robot from another store if it is better, as register_robot()
  /// does for a repeated registration. \return whether it was better.
  /// \throws Failure(Storage)
  bool offer_geometry(const Digest& robot, const RobotDescription& description,
                      std::int64_t now_ms);

  /// From memory, or read from the store and parsed.
  /// \return NotFound if the store has no such robot; Storage if its row is damaged, its
  /// description cannot be read any more (e.g. after an upgrade with a stricter parser) or the
  /// store cannot be read: a fault of the server, for which no report is refused.
  Result<RobotPointer> find(const Digest& robot);

  /// Gives a robot another label, durably. \return see Store::rename_robot().
  Result<bool> rename_robot(const Digest& robot, const std::string& label,
                            const AuditEntry* audit = nullptr);

  /// Removes a robot, durably. \return see Store::remove_robot().
  Result<store::RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop = {},
                                           const AuditEntry* audit = nullptr);

  /// Call when another server of the same store changed or removed a robot: it is read again when
  /// it is used next. \return whether the store has it. \throws Failure(Storage)
  bool read_again(const Digest& robot);

  /// Call when the store has no such robot (any more): the next registration is not answered as
  /// known.
  void forget(const Digest& robot) { forget(robot, false); }

  /// From memory only; null if it is not in memory.
  RobotPointer find_in_memory(const Digest& robot) const;
  std::size_t in_memory() const;

  /// Number of times better geometry of a robot was taken over: earlier results for it are of
  /// another geometry. From memory; 0 also for unknown robots.
  std::uint64_t geometry_revision(const Digest& robot) const;

  /// Ends comparisons with other robots: a registration lists the same arms found until then.
  void stop() noexcept { is_stopping_ = true; }

 private:
  struct Known {
    RobotPointer robot;
    std::uint64_t last_used = 0;
  };

  Result<RobotPointer> find(const Digest& robot, const kinematics::RobotModel* candidate);
  Result<RobotPointer> read(const Digest& robot, const kinematics::RobotModel* candidate);
  Robot robot_of(const kinematics::RobotModel& model, bool from_memory = false) const;
  bool take_contents(const RobotDescription& description, std::int64_t now_ms,
                     RegisterReply& reply);
  void name_meshes(const RobotDescription& asked, const Robot& known, bool has_room,
                   RegisterReply& reply) const;
  RobotPointer keep(Robot robot, std::uint64_t changes);
  std::uint64_t changes() const;
  void forget(const Digest& robot, bool is_deleted);
  void take_geometry(const kinematics::RobotModel& robot, std::int64_t now_ms,
                     RegisterReply& reply);
  std::optional<RegisterReply> refusal_of_known(const kinematics::RobotModel& robot,
                                                const LabelRule& may_take);
  std::optional<std::string> listed_label(const Digest& robot) const;
  std::vector<std::string> same_arms(const Digest& robot, const kinematics::Chain& chain);
  std::vector<std::string> same_arms_in_memory(const Digest& robot,
                                               const kinematics::Chain& chain) const;

  store::RobotStore& store_;
  const Options options_;
  std::atomic<bool> is_stopping_ = false;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::map<Digest, Known> robots_;
  mutable std::uint64_t uses_ = 0;
  std::uint64_t changes_ = 0;                           // of labels, and robots removed
  std::map<Digest, std::uint64_t> geometry_revisions_;  // those above 0
};

}  // namespace kinship::runtime
