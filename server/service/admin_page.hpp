#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/audit.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// The row of EvictDistribution.
struct Eviction {
  Digest id;
};

/// A robot as the first lines of an experience file name it.
struct ExportedRobot {
  RobotDescription description;
};

/// A line that goes out as it is, e.g. of a CSV file.
struct TextLine {
  std::string text;
};

/// What a verb answers with: Status one ServerStatus; a list verb its summaries; ShowRobot a
/// RobotSummary, then the RobotDescription; ShowTask a TaskSummary; ShowPath an Attempt;
/// ShowDistribution a Distribution; ExplainDistribution an Explanation; EvictDistribution an
/// Eviction; ExportPaths first ExportedRobots, then Attempts; RetirePath and ResetTask a
/// Retirement; RenameRobot a RobotSummary; RemoveRobot a RobotRemoval; JobRows TextLines; ListAudit
/// AuditEntries; the other verbs of jobs a Job each.
using AdminRow =
    std::variant<ServerStatus, RobotSummary, RobotDescription, TaskSummary, PathSummary,
                 AttemptSummary, Attempt, DistributionSummary, Distribution, Explanation, Eviction,
                 ExportedRobot, Retirement, RobotRemoval, Job, AuditEntry, TextLine>;

/// An AdminReply whose rows are values still.
struct AdminPage {
  AdminStatus status = AdminStatus::Failed;
  std::vector<AdminRow> rows;
  std::string next_cursor;
  std::string message;
};

/// What went wrong, as a page without rows.
AdminPage page_of(const Error& error);

/// How many rows a request asks for, at least 1.
std::size_t page_size(const AdminRequest& request);

template <typename Row>
AdminPage page_of(Row row) {
  AdminPage answer;
  answer.status = AdminStatus::Ok;
  answer.rows.emplace_back(std::move(row));
  return answer;
}

template <typename Row>
AdminPage page_of(Result<Row> row) {
  return row ? page_of(std::move(row).value()) : page_of(row.error());
}

template <typename Row>
AdminPage page_of(store::Page<Row> page) {
  AdminPage answer;
  answer.status = AdminStatus::Ok;
  for (Row& row : page.rows)
    answer.rows.emplace_back(std::move(row));
  answer.next_cursor = std::move(page.next_cursor);
  return answer;
}

}  // namespace kinship::service
