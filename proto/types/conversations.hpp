#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/admin_verb.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/selection.hpp"
#include "proto/types/task_experience.hpp"
#include "proto/types/uuid.hpp"

/// What the four conversations between client and server carry, as values.
namespace kinship {

/// When to ask again for what the server could not take now, as far as a reply says. Above 0 the
/// reply is not final, whatever its status: asked again later it may be another. At most
/// kMaxRetryAfter_ms.
using RetryAfter = std::chrono::milliseconds;

enum class RegisterStatus { Registered, Known, Refused };

struct RegisterReply {
  RegisterStatus status = RegisterStatus::Refused;
  Digest robot;
  std::uint32_t dof = 0;
  std::string solver;                       ///< what inverse kinematics will use for it
  std::string message;                      ///< why Refused
  std::vector<std::string> same_arms = {};  ///< labels of known robots that are the same arm
  GeometryGrade geometry_grade = GeometryGrade::None;  ///< of what the server filters with now
  bool took_geometry = false;  ///< Known, and this registration's geometry is better: it counts now
  /// What is filtered with what, and what is not and why, in words; empty from older servers.
  std::string geometry = {};
  RetryAfter retry_after{0};  ///< above 0: Refused for now alone
};

enum class ReceiptStatus { Stored, Duplicate, Recorded, Refused, TryAgain, UnknownRobot };

/// The server's answer to one attempt. Stored, Duplicate and Recorded follow a durable commit;
/// Refused is final; after TryAgain, or UnknownRobot once the robot is registered, send it again.
struct Receipt {
  Uuid report_uuid;
  ReceiptStatus status = ReceiptStatus::TryAgain;
  /// Why Refused, TryAgain or UnknownRobot; or why the path of a solved attempt is not kept:
  /// Recorded.
  std::string message;
};

/// A point of a store's history, sealed by the server that gave it: to be kept and given back as it
/// is. At most kMaxHistoryMarkBytes; empty: none.
using HistoryMark = std::vector<std::uint8_t>;

/// A batch of attempts; an empty one asks for the store's epoch.
struct ReportRequest {
  std::vector<Attempt> attempts;
  /// At the server only: answers to attempts of the batch that broke a rule of the contract and
  /// are therefore not among `attempts`. They belong into the reply.
  std::vector<Receipt> refused;
  HistoryMark known_mark = {};  ///< the newest that the client was given
};

struct ReportReply {
  Uuid store_epoch;
  std::vector<Receipt> receipts;  ///< at most one per attempt, found by UUID; missing: try again
  /// Of all that is durable; empty from older servers, and if there is nothing to say.
  HistoryMark history_mark = {};
  RetryAfter retry_after{0};  ///< when to send again what has no final receipt
  std::string message = {};   ///< why attempts have no receipt
};

struct FetchRequest {
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;
  std::string profile = "default";
  std::uint64_t minimum_generation = 0;   ///< of the robot's own experience; 0: any
  std::chrono::milliseconds deadline{0};  ///< 0: answer with what is there
  Selection selection;
  std::chrono::seconds follow{0};      ///< a lease on interest, at most kMaxFollow_s; 0: once
  std::uint32_t experience_bytes = 0;  ///< of the task's experience at most; 0: none is wanted
  std::uint64_t known_experience = 0;  ///< the revision the client holds: it is not sent again
  /// The reply waits, until the deadline at most, for a complete rehearsal. Needs experience_bytes.
  bool rehearsed = false;
};

enum class FetchStatus { Ready, Pending, NoExperience, UnknownRobot, Busy, Refused, Failed };

struct FetchReply {
  FetchStatus status = FetchStatus::Refused;
  std::optional<Distribution> distribution;  ///< present if Ready or Failed
  RetryAfter retry_after{0};                 ///< if Busy
  std::string message;
  /// Unless Refused or Busy: none if it was not asked for, is known already, or there is none.
  std::optional<TaskExperience> experience;
  /// Of this robot where it stands; none if no experience was asked for, or nothing was rehearsed
  /// yet.
  std::optional<Rehearsal> rehearsal = {};
};

struct AdminRequest {
  AdminVerb verb = AdminVerb::Status;
  std::string argument = {};  ///< what the verb is about: rule_of(verb).argument
  std::string robot = {};     ///< filter: label or digest prefix; empty: all. RenameRobot: which
  std::string task = {};      ///< filter; empty: all
  std::string cursor = {};    ///< from the page before; empty: the first page
  std::uint32_t limit = 100;  ///< rows a page
  std::chrono::milliseconds deadline{0};  ///< of ShowJob: how long it may wait for the end
};

enum class AdminStatus { Ok, NotFound, Refused, Failed };

struct AdminReply {
  AdminStatus status = AdminStatus::Refused;
  std::vector<std::string> rows;  ///< one document each (proto/json/summaries_json.hpp)
  std::string next_cursor;        ///< empty: no more pages
  std::string message;
  bool last_row_continues = false;  ///< the next page begins with the rest of the last row
  RetryAfter retry_after{0};        ///< above 0: Failed for now alone
};

}  // namespace kinship
