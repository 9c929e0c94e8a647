#include "server/runtime/robot_registry.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "robots/geometry/known_shapes.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/same_arm.hpp"

namespace kinship::runtime {
namespace {

constexpr std::size_t kMaxGeometryBytes = 1024;  // of words, with room for more in a message
constexpr RetryAfter kUnreadableRetry =
    std::chrono::minutes(1);  // a report or a repair mends a row

RegisterReply refused(const Error& error) {
  RegisterReply reply;
  reply.status = RegisterStatus::Refused;
  reply.message = error.message;
  return reply;
}

/// The part of a reply that the description alone gives.
RegisterReply reply_about(const kinematics::Chain& chain) {
  RegisterReply reply;
  reply.robot = chain.digest();
  reply.dof = static_cast<std::uint32_t>(chain.dof());
  reply.solver = inverse::solver_name(chain);
  return reply;
}

/// \param label  under which it was registered just now.
void describe_known(const Robot& known, const std::string& label, RegisterReply& reply) {
  reply.geometry_grade = known.grade;
  reply.geometry = known.geometry;
  if (known.label != label)
    reply.message = "known already, as '" + known.label + "'";
}

/// Which of two geometries of a robot is better: the filters', then that of pictures.
struct GeometryRank {
  GeometryGrade grade = GeometryGrade::None;
  std::ptrdiff_t collision = 0;  ///< meshes
  std::size_t meshes = 0;

  explicit GeometryRank(const Robot& robot)
      : grade(robot.grade),
        collision(std::ranges::count_if(robot.meshes, is_collision)),
        meshes(robot.meshes.size()) {}

  auto operator<=>(const GeometryRank&) const = default;
};

std::set<Digest> contents_of(const std::vector<LinkMesh>& meshes) {
  std::set<Digest> contents;
  for (const LinkMesh& mesh : meshes)
    contents.insert(mesh.content);
  return contents;
}

}  // namespace

std::string describe_meshes(const Robot& robot) {
  if (robot.meshes.empty())
    return "no mesh is named";
  const std::size_t all = contents_of(robot.meshes).size();
  const auto collision = std::ranges::count_if(robot.meshes, is_collision);
  return std::to_string(robot.meshes.size()) + " meshes, " + std::to_string(collision) +
         " of them for collision; " + std::to_string(all - robot.missing_meshes.size()) + " of " +
         std::to_string(all) + " contents are here, " + std::to_string(robot.mesh_bytes) +
         " bytes compressed";
}

/// A robot whose geometry cannot be read is a robot all the same: nothing is filtered then.
/// \param from_memory  without the store: no content of a mesh is known.
Robot RobotRegistry::robot_of(const kinematics::RobotModel& model, bool from_memory) const {
  Robot robot{model.chain.digest(), model.description.label, model.chain};
  robot.meshes = model.description.meshes;
  robot.missing_meshes = contents_of(robot.meshes);
  if (!robot.meshes.empty() && !from_memory)
    for (const auto& [known, bytes] : store_.known_meshes(robot.missing_meshes)) {
      robot.missing_meshes.erase(known);
      robot.mesh_bytes += bytes;
    }
  const bool are_all_here = std::ranges::none_of(robot.meshes, [&](const LinkMesh& mesh) {
    return is_collision(mesh) && robot.missing_meshes.contains(mesh.content);
  });
  geometry::FindMesh find;
  if (are_all_here)
    find = [this](const Digest& content) { return store_.find_mesh(content); };
  if (Result<geometry::KnownShapes> known = geometry::read_known_shapes(model, find)) {
    robot.geometry = geometry::describe(*known);
    robot.grade = known->grade;
    robot.covers = known->covers;
    robot.shapes = std::move(known).value().shapes;
  } else {
    robot.geometry = cut_text("cannot be read: " + known.error().message, kMaxGeometryBytes);
  }
  return robot;
}

RobotRegistry::RobotRegistry(store::RobotStore& store, Options options)
    : store_(store), options_(std::move(options)) {
  try {
    geometry_revisions_ = store.geometry_revisions();
  } catch (const Failure& failure) {  // damage: robots are read one by one all the same
    options_.on_unreadable(std::string("revisions of geometry: ") + failure.what());
  }
}

RegisterReply RobotRegistry::register_robot(const Candidate& candidate, std::int64_t now_ms,
                                            const LabelRule& may_take) {
  if (!candidate.robot())
    return refused(candidate.robot().error());
  const kinematics::RobotModel& robot = *candidate.robot();
  RegisterReply reply = reply_about(robot.chain);
  if (auto refusal = refusal_of_known(robot, may_take))
    return *std::move(refusal);
  const bool is_in_memory = store_.is_shared() && find_in_memory(reply.robot) != nullptr;
  const Result<RegisterStatus> status =
      is_in_memory ? RegisterStatus::Known
                   : store_.register_robot({.digest = reply.robot,
                                            .description = robot.description,
                                            .dof = reply.dof,
                                            .registered_ms = now_ms});
  if (!status)
    return refused(status.error());
  // Another client may have registered it meanwhile.
  if (*status == RegisterStatus::Known)
    if (auto refusal = refusal_of_known(robot, may_take))
      return *std::move(refusal);
  reply.status = *status;
  reply.same_arms = is_in_memory ? same_arms_in_memory(reply.robot, robot.chain)
                                 : same_arms(reply.robot, robot.chain);

  if (reply.status == RegisterStatus::Registered) {
    const std::lock_guard lock(mutex_);
    robots_.erase(reply.robot);  // of a row that was damaged, and is written anew
  } else {
    try {
      take_geometry(robot, now_ms, reply);
    } catch (const Failure&) {
      if (!is_in_memory)
        throw;  // else it is known all the same, and its geometry is offered again
    }
  }
  const bool has_room = take_contents(robot.description, now_ms, reply);
  if (const Result<RobotPointer> known = find(reply.robot, &robot)) {
    describe_known(*known.value(), robot.description.label, reply);
    name_meshes(robot.description, *known.value(), has_room, reply);
  }
  return reply;
}

std::optional<RegisterReply> RobotRegistry::register_known(const Candidate& candidate,
                                                           const LabelRule& may_take) const {
  if (!candidate.robot())
    return refused(candidate.robot().error());
  if (!store_.is_shared())
    return std::nullopt;  // registering mends a row that is damaged
  const kinematics::RobotModel& robot = *candidate.robot();
  RegisterReply reply = reply_about(robot.chain);
  const RobotPointer known = find_in_memory(reply.robot);
  if (!known)
    return std::nullopt;
  if (may_take)
    if (const auto refusal = may_take(known->label))
      return refused(*refusal);
  reply.status = RegisterStatus::Known;
  reply.same_arms = same_arms_in_memory(reply.robot, robot.chain);
  if (!robot.description.contents.empty() || robot.description.meshes.size() > known->meshes.size())
    return std::nullopt;
  if (GeometryRank(robot_of(robot, true)) > GeometryRank(*known))
    return std::nullopt;  // which is to be written
  describe_known(*known, robot.description.label, reply);
  name_meshes(robot.description, *known, true, reply);
  return reply;
}

bool RobotRegistry::offer_geometry(const Digest& robot, const RobotDescription& description,
                                   std::int64_t now_ms) {
  const Result<kinematics::RobotModel> offered = kinematics::read_model(description);
  if (!offered || offered->chain.digest() != robot)
    return false;
  RegisterReply reply;
  reply.robot = robot;
  take_geometry(*offered, now_ms, reply);
  static_cast<void>(take_contents(description, now_ms, reply));
  return reply.took_geometry;
}

std::optional<RegisterReply> RobotRegistry::refusal_of_known(const kinematics::RobotModel& robot,
                                                             const LabelRule& may_take) {
  if (!may_take)
    return std::nullopt;
  const Digest digest = robot.chain.digest();
  const Result<RobotPointer> known = find(digest, &robot);
  if (!known && known.error().code == ErrorCode::NotFound)
    return std::nullopt;
  // Registering its robot writes a damaged row anew, so its label still counts.
  const std::optional<std::string> label = known ? known.value()->label : listed_label(digest);
  if (!label) {
    // Without the store's words: they may name what the caller may not see.
    RegisterReply later =
        refused({known.error().code,
                 "robot " + digest.short_hex() + " is known, its label cannot be read now"});
    later.retry_after = kUnreadableRetry;
    return later;
  }
  const std::optional<Error> refusal = may_take(*label);
  return refusal ? std::optional(refused(*refusal)) : std::nullopt;
}

std::optional<std::string> RobotRegistry::listed_label(const Digest& robot) const {
  store::Page<RobotSummary> page;
  do {
    page = store_.list_robots(page.next_cursor, kMaxPageRows);
    for (const RobotSummary& row : page.rows)
      if (row.robot == robot)
        return row.label;
  } while (!page.next_cursor.empty());
  return std::nullopt;
}

/// Of a robot that is known. The second client with the same finds the first's.
void RobotRegistry::take_geometry(const kinematics::RobotModel& robot, std::int64_t now_ms,
                                  RegisterReply& reply) {
  const std::uint64_t changes_before = changes();
  const Result<RobotPointer> known = find(reply.robot, &robot);
  if (!known)
    return;
  Robot better = robot_of(robot);
  if (GeometryRank(better) <= GeometryRank(*known.value()))
    return;
  better.label = known.value()->label;
  better.geometry_revision = known.value()->geometry_revision + 1;
  reply.took_geometry =
      store_.replace_geometry({.digest = reply.robot,
                               .description = robot.description,
                               .dof = static_cast<std::uint32_t>(robot.chain.dof()),
                               .registered_ms = now_ms,
                               .geometry_revision = better.geometry_revision,
                               .geometry_ms = now_ms});
  if (!reply.took_geometry)
    return;
  // A robot renamed or removed meanwhile is not kept; nor may one read before the write be.
  if (keep(std::move(better), changes_before) != find_in_memory(reply.robot))
    forget(reply.robot, false);
}

/// The store counts geometry that is complete now as better, in the same transaction.
/// \return whether there was room for all.
bool RobotRegistry::take_contents(const RobotDescription& description, std::int64_t now_ms,
                                  RegisterReply& reply) {
  if (description.contents.empty() || options_.max_mesh_bytes == 0)
    return true;
  const store::MeshesPut put =
      store_.put_meshes(reply.robot, description.contents, {options_.max_mesh_bytes, now_ms});
  if (put.stored > 0)
    static_cast<void>(read_again(reply.robot));
  reply.took_geometry = reply.took_geometry || put.is_complete;
  if (put.over > 0)
    reply.meshes = std::to_string(put.over) + " contents are beyond the " +
                   std::to_string(options_.max_mesh_bytes >> 20U) + " MB of all robots; ";
  if (put.refused > 0)
    reply.meshes += std::to_string(put.refused) + " contents were not taken: " + put.why + "; ";
  return put.over == 0;
}

/// What of a registration's meshes is known, and which contents the server would take.
void RobotRegistry::name_meshes(const RobotDescription& asked, const Robot& known, bool has_room,
                                RegisterReply& reply) const {
  if (options_.max_mesh_bytes == 0)
    return;
  reply.meshes = cut_text(reply.meshes + describe_meshes(known), kMaxMessageBytes);
  if (!has_room)
    return;
  for (const Digest& content : contents_of(asked.meshes))
    if (known.missing_meshes.contains(content))
      reply.wanted.push_back({content});
}

Result<bool> RobotRegistry::rename_robot(const Digest& robot, const std::string& label,
                                         const AuditEntry* audit) {
  Result<bool> renamed = store_.rename_robot(robot, label, audit);
  forget(robot, false);
  return renamed;
}

Result<store::RemovedRobot> RobotRegistry::remove_robot(const Digest& robot,
                                                        const std::stop_token& stop,
                                                        const AuditEntry* audit) {
  Result<store::RemovedRobot> removed = store_.remove_robot(robot, stop, audit);
  forget(robot, removed && removed->removal.is_deleted);
  return removed;
}

bool RobotRegistry::read_again(const Digest& robot) {
  const std::optional<store::RobotRecord> record = store_.find_robot(robot);
  forget(robot, false);
  const std::lock_guard lock(mutex_);
  if (record && record->geometry_revision > 0)
    geometry_revisions_[robot] = record->geometry_revision;
  return record.has_value();
}

/// The next request reads it from the store, also one that is reading it just now.
void RobotRegistry::forget(const Digest& robot, bool is_deleted) {
  const std::lock_guard lock(mutex_);
  ++changes_;
  robots_.erase(robot);
  if (is_deleted)
    geometry_revisions_.erase(robot);
}

std::uint64_t RobotRegistry::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
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
  } catch (const Failure&) {  // the robot is registered; similar ones can be asked for again
  }
  return labels;
}

std::vector<std::string> RobotRegistry::same_arms_in_memory(const Digest& robot,
                                                            const kinematics::Chain& chain) const {
  std::vector<RobotPointer> others;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [digest, other] : robots_)
      if (digest != robot && other.robot->chain.dof() == chain.dof() &&
          others.size() < kMaxSameArms)
        others.push_back(other.robot);
  }
  std::vector<std::string> labels;
  for (const RobotPointer& other : others)
    if (!is_stopping_ &&
        kinematics::compare_arms(chain, other->chain) != kinematics::ArmLikeness::Different)
      labels.push_back(other->label);
  std::ranges::sort(labels);
  return labels;
}

Result<RobotRegistry::RobotPointer> RobotRegistry::find(const Digest& robot) {
  return find(robot, nullptr);
}

Result<RobotRegistry::RobotPointer> RobotRegistry::find(const Digest& robot,
                                                        const kinematics::RobotModel* candidate) {
  if (RobotPointer known = find_in_memory(robot))
    return known;
  Result<RobotPointer> found = read(robot, candidate);
  if (!found && found.error().code == ErrorCode::Storage)
    options_.on_unreadable(found.error().message);
  return found;
}

/// \param candidate  if not null, a description whose URDF is likely the same text.
Result<RobotRegistry::RobotPointer> RobotRegistry::read(const Digest& robot,
                                                        const kinematics::RobotModel* candidate) {
  const std::uint64_t changes_before = changes();
  std::optional<store::RobotRecord> record;
  try {
    record = store_.find_robot(robot);
    if (record && record->geometry_revision < geometry_revision(robot))
      record = store_.find_robot(robot);  // better geometry was taken over meanwhile
  } catch (const Failure& failure) {      // one damaged row must not cost the other robots
    return failure.error();
  }
  if (!record)
    return Error{ErrorCode::NotFound,
                 "robot " + robot.short_hex() + " is not known here; register it first"};
  const std::string name = "robot '" + record->description.label + "' (" + robot.short_hex() + ")";
  const bool is_same_text = candidate && candidate->description.urdf == record->description.urdf;
  const Result<kinematics::RobotModel> model = kinematics::read_model(
      std::move(record->description), is_same_text ? candidate->urdf : kinematics::UrdfModel());
  if (!model)
    return Error{ErrorCode::Storage, name + " cannot be read any more: " + model.error().message};
  const Digest digest = model->chain.digest();
  if (digest != robot)
    return Error{ErrorCode::Storage, name + " now reads as another robot, " + digest.short_hex()};
  Robot known = robot_of(*model);
  known.geometry_revision = record->geometry_revision;
  return keep(std::move(known), changes_before);
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

std::uint64_t RobotRegistry::geometry_revision(const Digest& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = geometry_revisions_.find(robot);
  return found == geometry_revisions_.end() ? 0 : found->second;
}

/// \param changes  as they were before it was read: if there were more since, it is not kept.
RobotRegistry::RobotPointer RobotRegistry::keep(Robot robot, std::uint64_t changes) {
  const auto pointer = std::make_shared<const Robot>(std::move(robot));
  const std::lock_guard lock(mutex_);
  if (changes != changes_)
    return pointer;
  Known& known = robots_[pointer->digest];
  if (!known.robot || known.robot->geometry_revision < pointer->geometry_revision)
    known.robot = pointer;
  if (known.robot->geometry_revision > 0)
    geometry_revisions_[pointer->digest] = known.robot->geometry_revision;
  known.last_used = ++uses_;
  RobotPointer kept = known.robot;
  if (robots_.size() > options_.max_robots)
    robots_.erase(std::ranges::min_element(
        robots_, {}, [](const auto& entry) { return entry.second.last_used; }));
  return kept;
}

}  // namespace kinship::runtime
