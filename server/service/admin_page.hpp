#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "proto/types/attempt.hpp"
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

template <typename... Rows>
std::variant<Rows..., RobotDescription, Attempt, Distribution, ExportedRobot, TextLine> row_with(
    const std::tuple<RowName<Rows>...>& rows);

/// A row of the answer to a verb (AdminVerb says which), not yet encoded.
using AdminRow = decltype(row_with(kAdminRows));

/// An AdminReply whose rows are not yet encoded.
struct AdminPage {
  AdminStatus status = AdminStatus::Failed;
  std::vector<AdminRow> rows;
  std::string next_cursor;
  std::string message;
  RetryAfter retry_after{0};
  ErrorCode error = ErrorCode::Internal;  ///< of a page that is not Ok
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

/// A page of all the rows that there are; its cursor is the number of rows before it.
/// \throws Failure(InvalidInput) for another cursor.
template <typename Row>
AdminPage page_of(const std::vector<Row>& all, const AdminRequest& request) {
  AdminPage answer;
  std::size_t next = row_number(request.cursor).value_or_throw();
  for (; next < all.size() && answer.rows.size() < page_size(request); ++next)
    answer.rows.emplace_back(all[next]);
  answer.status = AdminStatus::Ok;
  if (next < all.size())
    answer.next_cursor = std::to_string(next);
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
