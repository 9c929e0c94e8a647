#include "server/service/admin_page.hpp"

#include <algorithm>
#include <charconv>

#include "proto/types/limits.hpp"

namespace kinship::service {

AdminPage page_of(const Error& error) {
  AdminPage answer;
  answer.message = error.message;
  answer.error = error.code;
  switch (error.code) {
    case ErrorCode::NotFound:
      answer.status = AdminStatus::NotFound;
      break;
    case ErrorCode::InvalidInput:
    case ErrorCode::Conflict:
    case ErrorCode::TooLarge:
    case ErrorCode::Unavailable:
      answer.status = AdminStatus::Refused;
      break;
    case ErrorCode::Storage:
    case ErrorCode::Internal:
      answer.status = AdminStatus::Failed;
  }
  return answer;
}

std::size_t page_size(const AdminRequest& request) {
  return std::clamp<std::size_t>(request.limit, 1, kMaxPageRows);
}

Result<std::size_t> row_number(const std::string& cursor) {
  std::size_t number = 0;
  const char* const end = cursor.data() + cursor.size();
  const auto [rest, error] = std::from_chars(cursor.data(), end, number);
  if (!cursor.empty() && (error != std::errc() || rest != end))
    return Error{ErrorCode::InvalidInput, "'" + cursor + "' is no cursor of these rows"};
  return number;
}

}  // namespace kinship::service
