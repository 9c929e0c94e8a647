#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/uuid.hpp"

/// What the four conversations between client and server carry, as values.
namespace kinship {

enum class RegisterStatus { Registered, Known, Refused };

struct RegisterReply {
  RegisterStatus status = RegisterStatus::Refused;
  Digest robot;
  std::uint32_t dof = 0;
  std::string solver;   ///< what inverse kinematics will use for it
  std::string message;  ///< why Refused
};

enum class ReceiptStatus { Stored, Duplicate, Recorded, Refused, TryAgain, UnknownRobot };

/// The server's answer to one attempt. Stored, Duplicate and Recorded follow a durable commit;
/// Refused is final; after TryAgain, or UnknownRobot once the robot is registered, send it again.
struct Receipt {
  Uuid report_uuid;
  ReceiptStatus status = ReceiptStatus::TryAgain;
  std::string message;  ///< why Refused, TryAgain or UnknownRobot
};

/// A batch of attempts.
struct ReportRequest {
  std::vector<Attempt> attempts;
  /// At the server only: answers to attempts of the batch that broke a rule of the contract and
  /// are therefore not among `attempts`. They belong into the reply.
  std::vector<Receipt> refused;
};

struct ReportReply {
  Uuid store_epoch;
  std::vector<Receipt> receipts;  ///< at most one per attempt, found by UUID; missing: try again
};

struct FetchRequest {
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;
  std::string profile = "default";
  std::uint64_t minimum_generation = 0;   ///< of the robot's own experience; 0: any
  std::chrono::milliseconds deadline{0};  ///< 0: answer with what is there
};

enum class FetchStatus { Ready, Pending, NoExperience, UnknownRobot, Busy, Refused, Failed };

struct FetchReply {
  FetchStatus status = FetchStatus::Refused;
  std::optional<Distribution> distribution;  ///< present if Ready or Failed
  std::chrono::milliseconds retry_after{0};  ///< if Busy
  std::string message;
};

enum class AdminVerb {
  Status,
  ListRobots,
  ShowRobot,
  ListTasks,
  ShowTask,
  ListPaths,
  ShowPath,
  ListDistributions,
  ShowDistribution
};

struct AdminRequest {
  AdminVerb verb = AdminVerb::Status;
  std::string argument;       ///< label, digest prefix, task or UUID of a show verb
  std::string robot, task;    ///< filters of a list verb; empty: all
  std::string cursor;         ///< from the page before; empty: the first page
  std::uint32_t limit = 100;  ///< rows a page
};

enum class AdminStatus { Ok, NotFound, Refused, Failed };

struct AdminReply {
  AdminStatus status = AdminStatus::Refused;
  std::vector<std::string> rows;  ///< one JSON document each (proto/json/summaries.hpp)
  std::string next_cursor;        ///< empty: no more pages
  std::string message;
};

}  // namespace kinship
