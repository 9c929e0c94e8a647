#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/audit.hpp"
#include "proto/types/backup_summary.hpp"
#include "proto/types/client_use.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// A robot as the first lines of an experience file name it.
struct ExportedRobot {
  RobotDescription description;
};

/// A line that goes out as it is, e.g. of a CSV file.
struct TextLine {
  std::string text;
};

/// What a verb answers with (AdminVerb says which), as a value still.
using AdminRow = std::variant<ServerStatus, RobotSummary, RobotDescription, TaskSummary,
                              PathSummary, AttemptSummary, Attempt, DistributionSummary,
                              Distribution, Explanation, Eviction, ExportedRobot, Retirement,
                              RobotRemoval, Job, AuditEntry, ClientUse, BackupSummary, TextLine>;

/// An AdminReply whose rows are values still.
struct AdminPage {
  AdminStatus status = AdminStatus::Failed;
  std::vector<AdminRow> rows;
  std::string next_cursor;
  std::string message;
  RetryAfter retry_after{0};
};

/// What went wrong, as a page without rows.
AdminPage page_of(const Error& error);

/// How many rows a request asks for, at least 1.
std::size_t page_size(const AdminRequest& request);

/// Where a page begins whose cursor is how many rows, or bytes, come before it; none: 0.
/// \return InvalidInput for another cursor.
Result<std::size_t> row_number(const std::string& cursor);

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

/// So many of all rows, from the first one on; the cursor is the number of the next one.
template <typename Row>
AdminPage page_of(const std::vector<Row>& all, std::size_t first, std::size_t limit) {
  AdminPage answer;
  answer.status = AdminStatus::Ok;
  for (; first < all.size() && answer.rows.size() < limit; ++first)
    answer.rows.emplace_back(all[first]);
  if (first < all.size())
    answer.next_cursor = std::to_string(first);
  return answer;
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
