#include "server/app/admin_reply.hpp"

#include <variant>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::app {

namespace {

std::size_t bytes_of(const AdminReply& reply) {
  std::size_t bytes = 0;
  for (const std::string& row : reply.rows)
    bytes += row.size();
  return bytes;
}

template <typename Value>
std::string document(const Value& value) {
  return json::to_json(value);
}
std::string document(const service::ExportedRobot& robot) {
  return json::to_experience_line(robot.description);
}
std::string document(const service::TextLine& line) { return line.text; }

}  // namespace

std::string to_json(const service::AdminRow& row) {
  return std::visit([](const auto& value) { return document(value); }, row);
}

AdminReply to_reply(const service::AdminPage& page) {
  AdminReply reply;
  reply.status = page.status;
  reply.next_cursor = page.next_cursor;
  reply.message = page.message;
  reply.retry_after = page.retry_after;
  for (const service::AdminRow& row : page.rows)
    reply.rows.push_back(to_json(row));
  return reply;
}

bool fits_page(const AdminReply& reply) { return bytes_of(reply) <= kMaxPageBytes; }

std::optional<AdminRequest> for_fewer_rows(const AdminRequest& request, std::size_t rows) {
  if (!rule_of(request.verb).is(VerbRule::Lists) || rows < 2)
    return std::nullopt;
  AdminRequest smaller = request;
  smaller.limit = static_cast<std::uint32_t>(rows / 2);
  if (smaller.limit >= request.limit)
    return std::nullopt;
  return smaller;
}

AdminRequest for_rest(const AdminRequest& request, const RowCursor& begin) {
  AdminRequest inner = request;
  inner.cursor = begin.inner;
  const bool is_rest = begin.row > 0 || begin.byte > 0;
  if (is_rest && rule_of(request.verb).is(VerbRule::Lists))
    inner.limit = 1;  // only a single row of a listing is cut
  return inner;
}

}  // namespace kinship::app
