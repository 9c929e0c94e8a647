#include "client/link/admin_rows.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "proto/json/admin_rows_json.hpp"

namespace kinship::link {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kRowsPerPage = 200;
constexpr std::size_t kMaxRowBytes = 64'000'000;
constexpr milliseconds kProgressInterval{1000};

ErrorCode code_of(AdminStatus status) {
  switch (status) {
    case AdminStatus::NotFound:
      return ErrorCode::NotFound;
    case AdminStatus::Refused:
      return ErrorCode::InvalidInput;
    default:
      return ErrorCode::Internal;
  }
}

/// Puts rows together that were cut at the end of a page.
class RowJoiner {
 public:
  /// \return the whole row, once it is.
  std::optional<std::string> add(const std::string& piece, bool continues) {
    row_ += piece;
    if (continues)
      return std::nullopt;
    return std::exchange(row_, {});
  }
  std::size_t bytes() const noexcept { return row_.size(); }

 private:
  std::string row_;
};

AskAdmin asking(Client& server) {
  return [&server](const AdminRequest& request) { return server.admin(request); };
}

}  // namespace

std::optional<Error> for_each_row(const AskAdmin& ask, AdminRequest request,
                                  const std::function<bool(const std::string& row)>& use,
                                  std::size_t max_rows) {
  std::size_t rows_left = max_rows == 0 ? std::numeric_limits<std::size_t>::max() : max_rows;
  RowJoiner joiner;
  request.cursor.clear();
  while (true) {
    request.limit = static_cast<std::uint32_t>(std::min(rows_left, kRowsPerPage));
    const Result<AdminReply> reply = ask(request);
    if (!reply)
      return reply.error();
    if (reply->status != AdminStatus::Ok)
      return Error{code_of(reply->status), reply->message};
    for (std::size_t i = 0; i < reply->rows.size(); ++i) {
      const bool continues = reply->last_row_continues && i + 1 == reply->rows.size();
      const auto row = joiner.add(reply->rows[i], continues);
      if (row && (!use(*row) || --rows_left == 0))
        return std::nullopt;
    }
    if (joiner.bytes() > kMaxRowBytes)
      return Error{ErrorCode::TooLarge,
                   "a row of more than " + std::to_string(kMaxRowBytes) + " bytes"};
    if (reply->next_cursor.empty())
      return std::nullopt;
    request.cursor = reply->next_cursor;
  }
}

std::optional<Error> for_each_row(Client& server, AdminRequest request,
                                  const std::function<bool(const std::string& row)>& use,
                                  std::size_t max_rows) {
  return for_each_row(asking(server), std::move(request), use, max_rows);
}

Result<std::vector<std::string>> rows_of(Client& server, const AdminRequest& request) {
  std::vector<std::string> rows;
  const auto error = for_each_row(server, request, [&](const std::string& row) {
    rows.push_back(row);
    return true;
  });
  if (error)
    return *error;
  return rows;
}

Result<std::string> first_row_of(const AskAdmin& ask, const AdminRequest& request) {
  std::optional<std::string> first;
  const auto error = for_each_row(ask, request, [&](const std::string& row) {
    if (!first)
      first = row;
    return true;
  });
  if (error)
    return *error;
  if (!first)
    return Error{ErrorCode::Internal, "the server answered without a row"};
  return *std::move(first);
}

Result<std::string> first_row_of(Client& server, const AdminRequest& request) {
  return first_row_of(asking(server), request);
}

Error unreadable_row(const Error& why) {
  return {ErrorCode::Internal, "cannot read the server's row: " + why.message};
}

Result<Job> wait_for_job(Client& server, const std::string& id, Clock::time_point deadline,
                         const std::function<void(const Job&)>& on_progress) {
  AdminRequest request;
  request.verb = AdminVerb::ShowJob;
  request.argument = id;
  while (true) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
    request.deadline = std::clamp(left, milliseconds(0), kProgressInterval);
    Result<Job> job = row_of<Job>(server, request);
    if (job && on_progress)
      on_progress(*job);
    if (!job || has_ended(*job) || Clock::now() >= deadline)
      return job;
  }
}

bool has_ended(const Job& job) {
  return job.state != JobState::Queued && job.state != JobState::Running;
}

}  // namespace kinship::link
