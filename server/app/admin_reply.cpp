#include "server/app/admin_reply.hpp"

#include <variant>

#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/json/summaries_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::app {

namespace {

std::size_t bytes_of(const AdminReply& reply) {
  std::size_t bytes = 0;
  for (const std::string& row : reply.rows)
    bytes += row.size();
  return bytes;
}

bool is_listing(AdminVerb verb) {
  return verb == AdminVerb::ListRobots || verb == AdminVerb::ListTasks ||
         verb == AdminVerb::ListPaths || verb == AdminVerb::ListDistributions;
}

}  // namespace

std::string to_json(const service::AdminRow& row) {
  return std::visit([](const auto& value) { return json::to_json(value); }, row);
}

AdminReply to_reply(const service::AdminPage& page) {
  AdminReply reply;
  reply.status = page.status;
  reply.next_cursor = page.next_cursor;
  reply.message = page.message;
  for (const service::AdminRow& row : page.rows) {
    reply.rows.push_back(to_json(row));
    if (reply.rows.back().size() > kMaxPageBytes) {
      AdminReply failed;
      failed.status = AdminStatus::Failed;
      failed.message = "a row of " + std::to_string(reply.rows.back().size()) +
                       " bytes exceeds a page of " + std::to_string(kMaxPageBytes);
      return failed;
    }
  }
  return reply;
}

bool fits_page(const AdminReply& reply) { return bytes_of(reply) <= kMaxPageBytes; }

std::optional<AdminRequest> for_fewer_rows(const AdminRequest& request, std::size_t rows) {
  if (!is_listing(request.verb) || rows < 2)
    return std::nullopt;
  AdminRequest smaller = request;
  smaller.limit = static_cast<std::uint32_t>(rows / 2);
  if (smaller.limit >= request.limit)
    return std::nullopt;
  return smaller;
}

AdminReply too_large(const AdminReply& reply) {
  AdminReply failed;
  failed.status = AdminStatus::Failed;
  failed.message = std::to_string(reply.rows.size()) + " rows of " +
                   std::to_string(bytes_of(reply)) + " bytes exceed a page of " +
                   std::to_string(kMaxPageBytes);
  return failed;
}

}  // namespace kinship::app
