#include "server/runtime/robot_registry.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/same_arm.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::runtime {
namespace {

RegisterReply refused(const Error& error) {
  RegisterReply reply;
  reply.status = RegisterStatus::Refused;
  reply.message = error.message;
  return reply;
}

/// A robot whose geometry cannot be read is a robot all the same: nothing is filtered then.
Robot robot_of(const RobotDescription& description, kinematics::Chain chain) {
  Robot robot{chain.digest(), description.label, std::move(chain)};
  if (Result<geometry::RobotShapes> shapes =
          geometry::read_shapes(description, robot.chain, geometry::leave_out_mesh))
    robot.shapes = std::move(shapes).value();
  return robot;
}

}  // namespace

RegisterReply RobotRegistry::register_robot(const RobotDescription& description,
                                            std::int64_t now_ms) {
  if (const auto error = check_label(description.label))
    return refused(*error);
  Result<kinematics::Chain> chain = kinematics::read_chain(description);
  if (!chain)
    return refused(chain.error());

  RegisterReply reply;
  reply.robot = chain->digest();
  reply.dof = static_cast<std::uint32_t>(chain->dof());
  reply.solver = inverse::solver_name(*chain);
  const Result<RegisterStatus> status = store_.register_robot({.digest = reply.robot,
                                                               .description = description,
                                                               .dof = reply.dof,
                                                               .registered_ms = now_ms});
  if (!status)
    return refused(status.error());
  reply.status = *status;
  reply.same_arms = same_arms(reply.robot, *chain);

  if (reply.status == RegisterStatus::Registered) {
    keep(robot_of(description, std::move(chain).value()));
  } else if (const auto known = find(reply.robot);
             known && known.value()->label != description.label) {
    reply.message = "known already, as '" + known.value()->label + "'";
  }
  return reply;
}

std::vector<std::string> RobotRegistry::same_arms(const Digest& robot,
                                                  const kinematics::Chain& chain) {
  std::vector<std::string> labels;
  store::Page<RobotSummary> page;
  std::size_t compared = 0;
  const auto is_over = [&] {
    return labels.size() == kMaxSameArms || compared == kMaxSameArms || is_stopping_;
  };
  try {
    do {
      page = store_.list_robots(page.next_cursor, kMaxPageRows);
      for (const RobotSummary& other : page.rows) {
        if (other.robot == robot || other.dof != static_cast<std::uint32_t>(chain.dof()) ||
            is_over())
          continue;
        ++compared;
        const Result<RobotPointer> known = find(other.robot);
        if (known && kinematics::compare_arms(chain, known.value()->chain) !=
                         kinematics::ArmLikeness::Different)
          labels.push_back(other.label);
      }
    } while (!page.next_cursor.empty() && !is_over());
  } catch (const Failure&) {  // the robot is registered; whom it is like can be asked again
  }
  return labels;
}

Result<RobotRegistry::RobotPointer> RobotRegistry::find(const Digest& robot) {
  if (RobotPointer known = find_in_memory(robot))
    return known;
  Result<RobotPointer> found = read(robot);
  if (!found && found.error().code == ErrorCode::Storage)
    options_.on_unreadable(found.error().message);
  return found;
}

Result<RobotRegistry::RobotPointer> RobotRegistry::read(const Digest& robot) {
  std::optional<store::RobotRecord> record;
  try {
    record = store_.find_robot(robot);
  } catch (const Failure& failure) {  // one damaged row must not cost the other robots
    return failure.error();
  }
  if (!record)
    return Error{ErrorCode::NotFound,
                 "robot " + robot.short_hex() + " is not known here; register it first"};
  Result<kinematics::Chain> chain = kinematics::read_chain(record->description);
  const std::string name = "robot '" + record->description.label + "' (" + robot.short_hex() + ")";
  if (!chain)
    return Error{ErrorCode::Storage, name + " cannot be read any more: " + chain.error().message};
  if (chain->digest() != robot)
    return Error{ErrorCode::Storage,
                 name + " now reads as another robot, " + chain->digest().short_hex()};
  return keep(robot_of(record->description, std::move(chain).value()));
}

RobotRegistry::RobotPointer RobotRegistry::find_in_memory(const Digest& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = robots_.find(robot);
  if (found == robots_.end())
    return nullptr;
  found->second.last_used = ++uses_;
  return found->second.robot;
}

std::size_t RobotRegistry::in_memory() const {
  const std::lock_guard lock(mutex_);
  return robots_.size();
}

RobotRegistry::RobotPointer RobotRegistry::keep(Robot robot) {
  const auto pointer = std::make_shared<const Robot>(std::move(robot));
  const std::lock_guard lock(mutex_);
  Known& known = robots_[pointer->digest];
  if (!known.robot)
    known.robot = pointer;
  known.last_used = ++uses_;
  RobotPointer kept = known.robot;
  if (robots_.size() > options_.max_robots)
    robots_.erase(std::ranges::min_element(
        robots_, {}, [](const auto& entry) { return entry.second.last_used; }));
  return kept;
}

}  // namespace kinship::runtime
