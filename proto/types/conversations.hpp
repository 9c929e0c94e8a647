#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/admin_verb.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/names.hpp"
#include "proto/types/recall_library.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/selection.hpp"
#include "proto/types/task_experience.hpp"
#include "proto/types/uuid.hpp"

/// Values of the four conversations between client and server.
namespace kinship {

/// Time after which to repeat a request that the server could not serve now. Above 0 the reply is
/// not final, whatever its status: a later one may differ. At most kMaxRetryAfter_ms.
using RetryAfter = std::chrono::milliseconds;
inline constexpr FieldRules kRetryAfterRules{
    .min = 0, .max = kMaxRetryAfter_ms, .is_clamped = true};

/// Names the content of a mesh.
struct MeshDigest {
  Digest content;

  auto operator<=>(const MeshDigest&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<MeshDigest>{Field{"content", &MeshDigest::content}};

enum class RegisterStatus { Registered, Known, Refused };

struct RegisterReply {
  RegisterStatus status = RegisterStatus::Refused;
  Digest robot;
  std::uint32_t dof = 0;
  std::string solver;                       ///< inverse kinematics solver for it
  std::string message;                      ///< why Refused
  std::vector<std::string> same_arms = {};  ///< labels of known robots that are the same arm
  GeometryGrade geometry_grade = GeometryGrade::None;  ///< of the server's filters now
  bool took_geometry = false;  ///< Known, and this registration's better geometry was taken over
  /// Filters, their geometry, and links not filtered with the reason, as text; empty from older
  /// servers.
  std::string geometry = {};
  RetryAfter retry_after{0};  ///< above 0: Refused only for now
  /// Contents of this registration's meshes that the server lacks and takes; empty from servers
  /// that take none.
  std::vector<MeshDigest> wanted = {};
  std::string meshes = {};  ///< what of the meshes is there; empty: the server takes none
};

template <>
inline constexpr std::tuple kFieldsOf<RegisterReply>{
    Field{"status", &RegisterReply::status, {.max = static_cast<double>(RegisterStatus::Refused)}},
    Field{"robot", &RegisterReply::robot},
    Field{"dof", &RegisterReply::dof, between(0, kMaxDof)},
    Field{"solver", &RegisterReply::solver, {.limit = kMaxPlannerBytes}},
    Field{"message", &RegisterReply::message, {.limit = kMaxMessageBytes}},
    Field{"same_arms",
          &RegisterReply::same_arms,
          {.limit = kMaxSameArms, .element_limit = kMaxLabelBytes}},
    Field{"geometry_grade",
          &RegisterReply::geometry_grade,
          {.max = static_cast<double>(GeometryGrade::Exact)}},
    Field{"took_geometry", &RegisterReply::took_geometry},
    Field{"geometry", &RegisterReply::geometry, {.limit = kMaxMessageBytes}},
    Field{"retry_after_ms", &RegisterReply::retry_after, kRetryAfterRules},
    Field{"wanted", &RegisterReply::wanted, {.limit = kMaxLinkMeshes}},
    Field{"meshes", &RegisterReply::meshes, {.limit = kMaxMessageBytes}}};

enum class ReceiptStatus { Stored, Duplicate, Recorded, Refused, TryAgain, UnknownRobot };

/// The server's answer to one attempt. Stored, Duplicate and Recorded follow a durable commit;
/// Refused is final; after TryAgain, or UnknownRobot once the robot is registered, send it again.
struct Receipt {
  Uuid report_uuid;
  ReceiptStatus status = ReceiptStatus::TryAgain;
  /// Why Refused, TryAgain or UnknownRobot; or why the path of a solved attempt is not stored:
  /// Recorded.
  std::string message;
};

template <>
inline constexpr std::tuple kFieldsOf<Receipt>{
    Field{"report_uuid", &Receipt::report_uuid},
    Field{"status", &Receipt::status, {.max = static_cast<double>(ReceiptStatus::UnknownRobot)}},
    Field{"message", &Receipt::message, {.limit = kMaxMessageBytes}}};

/// A consistency token: a point of a store's history, authenticated by the store's key. A client
/// keeps it and returns it unchanged. At most kMaxConsistencyTokenBytes; empty: none.
using ConsistencyToken = std::vector<std::uint8_t>;

/// A batch of attempts; an empty one requests the store's epoch.
struct ReportRequest {
  std::vector<Attempt> attempts;
  /// At the server only: answers to attempts of the batch that broke a rule of the contract and are
  /// therefore not among `attempts`. They become part of the reply.
  std::vector<Receipt> refused;
  ConsistencyToken known_token = {};  ///< the newest that the client received
};

struct ReportReply {
  Uuid store_epoch;
  std::vector<Receipt> receipts;  ///< at most one per attempt, found by UUID; missing: try again
  /// Covers all durable data; empty from older servers, and if there is none.
  ConsistencyToken consistency_token = {};
  RetryAfter retry_after{0};  ///< when to resend attempts without a final receipt
  std::string message = {};   ///< why attempts have no receipt
};

template <>
inline constexpr std::tuple kFieldsOf<ReportReply>{
    Field{"store_epoch", &ReportReply::store_epoch},
    Field{"receipts", &ReportReply::receipts, {.limit = kMaxAttemptsPerBatch}},
    Field{
        "consistency_token", &ReportReply::consistency_token, {.limit = kMaxConsistencyTokenBytes}},
    Field{"retry_after_ms", &ReportReply::retry_after, kRetryAfterRules},
    Field{"message", &ReportReply::message, {.limit = kMaxMessageBytes}}};

struct FetchRequest {
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;
  std::string profile = "default";
  std::uint64_t minimum_generation = 0;   ///< of the robot's own experience; 0: any
  std::chrono::milliseconds deadline{0};  ///< 0: answer at once
  Selection selection;
  std::chrono::seconds follow{0};      ///< a lease on interest, at most kMaxFollow_s; 0: once
  std::uint32_t experience_bytes = 0;  ///< limit of the task's experience; 0: none
  std::uint64_t known_experience = 0;  ///< the revision that the client has: not sent again
  /// The reply waits, until the deadline at most, for a complete rehearsal, here or near
  /// by. Needs experience_bytes.
  bool rehearsed = false;
  std::uint64_t known_recall = 0;  ///< revision of the library that the client has: not sent again
  /// Where queries of the robot usually begin, joint units: what other robots recorded is planned
  /// from there. Empty: the server looks for a start.
  std::vector<double> start = {};
  /// Where the transfer frame is to go in the query that the request is for: what other robots
  /// recorded, and this one cannot plan to its recorded goal, is planned to there.
  std::optional<Eigen::Isometry3d> T_task_goal = {};
  bool to_configuration = false;  ///< queries ask for one configuration, not for any at a pose
};

template <>
inline constexpr std::tuple kFieldsOf<FetchRequest>{
    Field{"task", &FetchRequest::task, {.check = check_task}},
    Field{"robot", &FetchRequest::robot},
    Field{"T_task_base", &FetchRequest::T_task_base},
    Field{"profile", &FetchRequest::profile, {.limit = kMaxProfileBytes}},
    Field{"minimum_generation", &FetchRequest::minimum_generation},
    Field{"deadline_ms", &FetchRequest::deadline, between(0, kMaxFetchDeadline_ms)},
    Field{"selection", &FetchRequest::selection},
    Field{"follow_s", &FetchRequest::follow, between(0, kMaxFollow_s)},
    Field{"experience_bytes", &FetchRequest::experience_bytes, between(0, kMaxExperienceBytes)},
    Field{"known_experience", &FetchRequest::known_experience},
    Field{"rehearsed", &FetchRequest::rehearsed},
    Field{"known_recall", &FetchRequest::known_recall},
    Field{"start", &FetchRequest::start, {.limit = kMaxDof}},
    Field{"T_task_goal", &FetchRequest::T_task_goal},
    Field{"to_configuration", &FetchRequest::to_configuration}};

enum class FetchStatus { Ready, Pending, NoExperience, UnknownRobot, Busy, Refused, Failed };

struct FetchReply {
  FetchStatus status = FetchStatus::Refused;
  std::optional<Distribution> distribution;  ///< present if Ready or Failed
  RetryAfter retry_after{0};                 ///< if Busy
  std::string message;
  /// Unless Refused or Busy: missing if it was not requested, is known already, or does not exist.
  std::optional<TaskExperience> experience;
  /// Of this robot at its placement; missing if no experience was requested, or there is no
  /// rehearsal yet.
  std::optional<Rehearsal> rehearsal = {};
  /// Of this robot; missing if no experience was requested, it is known already, or there is none.
  std::optional<RecallLibrary> recall = {};
};

template <>
inline constexpr std::tuple kFieldsOf<FetchReply>{
    Field{"status", &FetchReply::status, {.max = static_cast<double>(FetchStatus::Failed)}},
    Field{"distribution", &FetchReply::distribution},
    Field{"retry_after_ms", &FetchReply::retry_after,
          between(0, std::numeric_limits<std::uint32_t>::max())},
    Field{"message", &FetchReply::message, {.limit = kMaxMessageBytes}},
    Field{"experience", &FetchReply::experience},
    Field{"rehearsal", &FetchReply::rehearsal},
    Field{"recall", &FetchReply::recall}};

struct AdminRequest {
  AdminVerb verb = AdminVerb::Status;
  std::string argument = {};  ///< object of the verb: rule_of(verb).argument
  std::string robot = {};   ///< filter: label or digest prefix; empty: all. RenameRobot: the robot
  std::string task = {};    ///< filter; empty: all
  std::string cursor = {};  ///< from the page before; empty: the first page
  std::uint32_t limit = 100;              ///< rows a page
  std::chrono::milliseconds deadline{0};  ///< of ShowJob: longest wait for the end
  /// That the sender has the server's token (proto/security/admin_token); empty: none is shown.
  std::string proof = {};
};

template <>
inline constexpr std::tuple kFieldsOf<AdminRequest>{
    Field{"verb", &AdminRequest::verb, {.max = static_cast<double>(kLastVerb)}},
    Field{"argument", &AdminRequest::argument, {.limit = kMaxTaskBytes}},
    Field{"robot", &AdminRequest::robot, {.limit = kMaxTaskBytes}},
    Field{"task", &AdminRequest::task, {.limit = kMaxTaskBytes}},
    Field{"cursor", &AdminRequest::cursor, {.limit = kMaxCursorBytes}},
    Field{"limit", &AdminRequest::limit, between(1, kMaxPageRows)},
    Field{"deadline_ms", &AdminRequest::deadline, between(0, kMaxFetchDeadline_ms)},
    Field{"proof", &AdminRequest::proof, {.limit = kMaxProofBytes}}};

enum class AdminStatus { Ok, NotFound, Refused, Failed };

struct AdminReply {
  AdminStatus status = AdminStatus::Refused;
  std::vector<std::string> rows;  ///< one document each (proto/json/admin_rows_json.hpp)
  std::string next_cursor;        ///< empty: no more pages
  std::string message;
  bool last_row_continues = false;  ///< the next page begins with the rest of the last row
  RetryAfter retry_after{0};        ///< above 0: Failed only for now
};

template <>
inline constexpr std::tuple kFieldsOf<AdminReply>{
    Field{"status", &AdminReply::status, {.max = static_cast<double>(AdminStatus::Failed)}},
    Field{"rows", &AdminReply::rows, {.limit = kMaxPageRows, .element_limit = kMaxPageBytes}},
    Field{"next_cursor", &AdminReply::next_cursor, {.limit = kMaxCursorBytes}},
    Field{"message", &AdminReply::message, {.limit = kMaxMessageBytes}},
    Field{"last_row_continues", &AdminReply::last_row_continues},
    Field{"retry_after_ms", &AdminReply::retry_after, kRetryAfterRules}};

}  // namespace kinship
