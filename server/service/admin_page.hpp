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
#include "server/store/page.hpp"

namespace kinship::service {

/// A robot as the first lines of an experience file name it.
struct ExportedRobot {
  RobotDescription description;
};

/// A line that is sent unchanged, e.g. of a CSV file.
struct TextLine {
  std::string text;
};

/// A row of the answer to a verb (AdminVerb says which), not yet encoded.
using AdminRow = std::variant<ServerStatus, RobotSummary, RobotDescription, TaskSummary,
                              PathSummary, AttemptSummary, Attempt, DistributionSummary,
                              Distribution, Explanation, Eviction, ExportedRobot, Retirement,
                              RobotRemoval, Job, AuditEntry, ClientUse, BackupSummary, TextLine>;

/// An AdminReply whose rows are not yet encoded.
struct AdminPage {
  AdminStatus status = AdminStatus::Failed;
  std::vector<AdminRow> rows;
  std::string next_cursor;
  std::string message;
  RetryAfter retry_after{0};
};

/// The error as a page without rows.
AdminPage page_of(const Error& error);

/// Number of rows that a request asks for, at least 1.
std::size_t page_size(const AdminRequest& request);

/// Beginning of a page whose cursor is the number of rows, or bytes, before it; empty cursor: 0.
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

/// At most `limit` rows of `all` from `first` on; the cursor is the index of the next row.
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
