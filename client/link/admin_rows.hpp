#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// Answers to admin verbs that are longer than one page, or that take their time.
namespace kinship::link {

/// Asks page after page and calls `use` with each row, one that came in pieces once it is whole.
/// \param request   its cursor and limit are set here.
/// \param use       returns false to stop.
/// \param max_rows  0: all.
/// \return what went wrong, if anything: NotFound, InvalidInput (refused), Internal (failed) with
///         the server's message; Unavailable; TooLarge for a row that has no end.
std::optional<Error> for_each_row(Client& server, AdminRequest request,
                                  const std::function<bool(const std::string& row)>& use,
                                  std::size_t max_rows = 0);

/// All rows at once, for verbs that answer with few.
Result<std::vector<std::string>> rows_of(Client& server, const AdminRequest& request);

/// The first row, for verbs that answer with one. \return Internal if there is none.
Result<std::string> first_row_of(Client& server, const AdminRequest& request);

/// The same, as a value: the job that a verb began, say. \return Internal if it cannot be read.
/// \param Row  a row of proto/json/admin_rows_json.hpp that the source instantiates.
template <typename Row>
Result<Row> row_of(Client& server, const AdminRequest& request);

/// Waits until a job has ended or the time has come.
/// \param on_progress  called every second or so with what is known of it; may be empty.
/// \return the job as it is then; NotFound if the server does not know it (any more).
Result<Job> wait_for_job(Client& server, const std::string& id,
                         std::chrono::steady_clock::time_point deadline,
                         const std::function<void(const Job&)>& on_progress = {});

/// Whether a job is done, failed or cancelled.
bool has_ended(const Job& job);

}  // namespace kinship::link
