#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// Admin replies of several pages, and the jobs that admin requests begin.
namespace kinship::link {

/// Sends an admin request and waits for its reply, as Client::admin() does.
using AskAdmin = std::function<Result<AdminReply>(const AdminRequest&)>;

/// Requests page after page and calls `use` with each row; a row sent in pieces is joined first.
/// \param request   its cursor and limit are set here.
/// \param use       returns false to stop.
/// \param max_rows  0: all.
/// \return the error, if any: NotFound, InvalidInput (refused), Internal (failed) with the server's
///         message; Unavailable; TooLarge for a row that has no end.
std::optional<Error> for_each_row(const AskAdmin& ask, AdminRequest request,
                                  const std::function<bool(const std::string& row)>& use,
                                  std::size_t max_rows = 0);
std::optional<Error> for_each_row(Client& server, AdminRequest request,
                                  const std::function<bool(const std::string& row)>& use,
                                  std::size_t max_rows = 0);

/// All rows at once, for verbs whose reply has few.
Result<std::vector<std::string>> rows_of(Client& server, const AdminRequest& request);

/// The document of the first row, for verbs whose reply has one. \return Internal if there is none.
Result<std::string> first_row_of(const AskAdmin& ask, const AdminRequest& request);
Result<std::string> first_row_of(Client& server, const AdminRequest& request);

/// The error for a row that cannot be read.
Error unreadable_row(const Error& why);

/// The first row, for verbs whose reply has one: for example the job that a verb began. \return
/// Internal if there is none, or it cannot be read.
template <json::AdminRow Row>
Result<Row> row_of(Client& server, const AdminRequest& request) {
  const Result<std::string> text = first_row_of(server, request);
  if (!text)
    return text.error();
  Result<Row> row = json::row_from_json<Row>(*text);
  return row ? row : unreadable_row(row.error());
}

/// Waits until a job has ended or the deadline has passed.
/// \param on_progress  called about once a second with the job's state; may be empty.
/// \return the job as it is then; NotFound if the server does not know it (any more).
Result<Job> wait_for_job(Client& server, const std::string& id,
                         std::chrono::steady_clock::time_point deadline,
                         const std::function<void(const Job&)>& on_progress = {});

/// Whether a job is done, failed or cancelled.
bool has_ended(const Job& job);

}  // namespace kinship::link
