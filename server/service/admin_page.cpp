#include "server/service/admin_page.hpp"

#include <algorithm>

#include "proto/types/limits.hpp"

namespace kinship::service {

AdminPage page_of(const Error& error) {
  AdminPage answer;
  answer.message = error.message;
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

}  // namespace kinship::service
