#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"
#include "server/store/store.hpp"

namespace kinship::runtime {

/// A robot that the service can compute with.
struct Robot {
  Digest digest;
  std::string label;
  kinematics::Chain chain;
  /// Of the URDF's meshes the solids that a client fitted around them, if one did; nothing if the
  /// geometry cannot be read.
  geometry::RobotShapes shapes = {};
  GeometryGrade grade = GeometryGrade::None;
  std::string geometry = {};            ///< what the shapes are, in words
  std::uint64_t geometry_revision = 0;  ///< how often better geometry was taken over
};

/// Knows the robots of a store and keeps those that were used last parsed in memory. May be
/// shared between threads; no lock is held while it parses or reads the store.
class RobotRegistry {
 public:
  /// The registry and whoever computes with the robot share it: it never changes.
  using RobotPointer = std::shared_ptr<const Robot>;

  /// Why a robot of this label is not for who asks; nothing if it is.
  using LabelRule = std::function<std::optional<Error>(const std::string& label)>;

  struct Options {
    std::size_t max_robots = 1024;  ///< in memory; the one not used for longest goes first
    /// A stored robot cannot be read, with its name and why. Called from any thread.
    std::function<void(const std::string& message)> on_unreadable = [](const std::string&) {};
  };

  /// \param store  outlives the registry.
  explicit RobotRegistry(store::Store& store) : RobotRegistry(store, Options{}) {}
  RobotRegistry(store::Store& store, Options options);

  /// Parses, identifies and stores a robot, and tells which other robots of the store are the same
  /// arm: at most kMaxSameArms labels, in their order, none if the store cannot tell. Refused, with
  /// the reason, if the description breaks a rule or its label belongs to another robot.
  ///
  /// A known robot's description takes the place of the one before, but for its label, if its
  /// geometry is better: exact shapes before solids around meshes before those of some links only
  /// before none; of equals the first stays.
  ///
  /// It is compared with robots of as many joints, the first kMaxSameArms of them; those that are
  /// not in memory are read.
  ///
  /// Where other servers share the store, one that is in memory is known without asking the store,
  /// and compared with what is in memory: it is answered also while the store cannot be reached.
  /// \param now_ms    Unix time, UTC.
  /// \param may_take  asked with the label under which the robot is known, before anything of it
  ///                  is changed or told; empty: whoever registers a known robot may.
  /// \throws Failure(Storage), also if that label cannot be told now.
  RegisterReply register_robot(const RobotDescription& description, std::int64_t now_ms,
                               const LabelRule& may_take = {});

  /// The same if memory can answer it, which asks the store nothing: where other servers share the
  /// store, for a robot in memory whose geometry is not better than what is known, and for what is
  /// refused whatever the store has. Nothing: register_robot() is to be asked.
  std::optional<RegisterReply> register_known(const RobotDescription& description,
                                              const LabelRule& may_take = {}) const;

  /// Takes over the geometry of a known robot that somebody else knows better, as
  /// register_robot() does of who registers it again. \return whether it was better.
  /// \throws Failure(Storage)
  bool offer_geometry(const Digest& robot, const RobotDescription& description,
                      std::int64_t now_ms);

  /// From memory, or read from the store and parsed.
  /// \return NotFound if the store has no such robot; Storage if its row is damaged, its
  /// description
  ///         cannot be read any more (as after an upgrade with a stricter parser) or the store
  ///         cannot be read: a fault of the server's own, which nobody else's report is refused
  ///         for.
  Result<RobotPointer> find(const Digest& robot);

  /// Gives a robot another label, durably. \return as Store::rename_robot() does.
  Result<bool> rename_robot(const Digest& robot, const std::string& label,
                            const AuditEntry* audit = nullptr);

  /// Takes a robot out, durably. \return as Store::remove_robot() does.
  Result<store::RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop = {},
                                           const AuditEntry* audit = nullptr);

  /// Another server of the same store changed a robot, or took it out: it is read when somebody
  /// asks for it next. \return whether it is there. \throws Failure(Storage)
  bool read_again(const Digest& robot);

  /// The store said that it has no such robot (any more): whoever registers it next is not told
  /// that it is known.
  void forget(const Digest& robot) { forget(robot, false); }

  /// From memory only; null if it is not there.
  RobotPointer find_in_memory(const Digest& robot) const;
  std::size_t in_memory() const;

  /// How often better geometry of a robot was taken over: what was made for it before is of another
  /// geometry. From memory; 0 also for robots that are not known.
  std::uint64_t geometry_revision(const Digest& robot) const;

  /// Comparing with other robots ends: whoever registers is told of those found until then.
  void stop() noexcept { is_stopping_ = true; }

 private:
  struct Known {
    RobotPointer robot;
    std::uint64_t last_used = 0;
  };

  Result<RobotPointer> read(const Digest& robot);
  RobotPointer keep(Robot robot, std::uint64_t changes);
  std::uint64_t changes() const;
  void forget(const Digest& robot, bool is_deleted);
  void take_geometry(Robot better, const RobotDescription& description, std::int64_t now_ms,
                     RegisterReply& reply);
  std::optional<Error> refusal_of_known(const Digest& robot, const LabelRule& may_take);
  std::optional<std::string> listed_label(const Digest& robot) const;
  std::vector<std::string> same_arms(const Digest& robot, const kinematics::Chain& chain);
  std::vector<std::string> same_arms_in_memory(const Digest& robot,
                                               const kinematics::Chain& chain) const;

  store::Store& store_;
  const Options options_;
  std::atomic<bool> is_stopping_ = false;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::map<Digest, Known> robots_;
  mutable std::uint64_t uses_ = 0;
  std::uint64_t changes_ = 0;                           // of labels, and robots removed
  std::map<Digest, std::uint64_t> geometry_revisions_;  // those above 0
};

}  // namespace kinship::runtime
