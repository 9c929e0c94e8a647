#include "proto/codec/admin_codec.hpp"

#include "proto/codec/reader.hpp"
#include "proto/codec/retry_after.hpp"
#include "proto/codec/writer.hpp"

namespace kinship::codec {
namespace {

std::optional<Error> validate(const AdminReply& reply) {
  Rules rules;
  rules.at_most("rows", reply.rows.size(), kMaxPageRows)
      .text("next_cursor", reply.next_cursor, kMaxCursorBytes)
      .text("message", reply.message, kMaxMessageBytes);
  rules.that(!reply.last_row_continues || (!reply.rows.empty() && !reply.next_cursor.empty()),
             "last_row_continues: without a row or a next page");
  std::size_t bytes = 0;
  for (const std::string& row : reply.rows) {
    rules.text("row", row, kMaxPageBytes);
    bytes += row.size();
  }
  return rules.at_most("rows (bytes)", bytes, kMaxPageBytes).broken();
}

}  // namespace

std::optional<Error> validate(const AdminRequest& request) {
  return Rules()
      .text("argument", request.argument, kMaxTaskBytes)
      .text("robot", request.robot, kMaxTaskBytes)
      .text("task", request.task, kMaxTaskBytes)
      .text("cursor", request.cursor, kMaxCursorBytes)
      .between("limit", request.limit, 1, kMaxPageRows)
      .between("deadline (ms)", static_cast<double>(request.deadline.count()), 0,
               static_cast<double>(kMaxFetchDeadline_ms))
      .broken();
}

Result<Message<kinship_wire_AdminRequest>> encode(const Head& head, const AdminRequest& request) {
  if (const auto error = validate(request))
    return *error;
  Message<kinship_wire_AdminRequest> message(head);
  Arena& arena = *message.arena;
  auto& wire = message.wire;
  wire.verb = static_cast<std::uint32_t>(request.verb);
  wire.argument = arena.text(request.argument);
  wire.robot = arena.text(request.robot);
  wire.task = arena.text(request.task);
  wire.cursor = arena.text(request.cursor);
  wire.limit = request.limit;
  wire.deadline_ms = static_cast<std::uint32_t>(request.deadline.count());
  return message;
}

Result<AdminRequest> decode(const kinship_wire_AdminRequest& wire) {
  Reader reader;
  AdminRequest request;
  request.verb = reader.enumerator("verb", wire.verb, kLastVerb);
  request.argument = reader.text("argument", wire.argument, kMaxTaskBytes);
  request.robot = reader.text("robot", wire.robot, kMaxTaskBytes);
  request.task = reader.text("task", wire.task, kMaxTaskBytes);
  request.cursor = reader.text("cursor", wire.cursor, kMaxCursorBytes);
  request.limit = wire.limit;
  request.deadline = std::chrono::milliseconds(wire.deadline_ms);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(request))
    return *error;
  return request;
}

Result<Message<kinship_wire_AdminReply>> encode(const Head& head, const AdminReply& reply) {
  if (const auto error = validate(reply))
    return *error;
  Message<kinship_wire_AdminReply> message(head);
  Arena& arena = *message.arena;
  auto& wire = message.wire;
  wire.status = static_cast<std::uint32_t>(reply.status);
  arena.resize(wire.rows, reply.rows.size());
  for (std::size_t i = 0; i < reply.rows.size(); ++i)
    wire.rows._buffer[i] = arena.text(reply.rows[i]);
  wire.next_cursor = arena.text(reply.next_cursor);
  wire.message = arena.text(reply.message);
  wire.last_row_continues = reply.last_row_continues;
  wire.retry_after_ms = retry_after_ms(reply.retry_after);
  return limited(std::move(message));
}

Result<AdminReply> decode(const kinship_wire_AdminReply& wire) {
  Reader reader;
  AdminReply reply;
  reply.status = reader.enumerator("status", wire.status, AdminStatus::Failed);
  reader.rules.at_most("rows", wire.rows._length, kMaxPageRows);
  if (reader.rules.broken())
    return *reader.rules.broken();
  for (const char* row : elements(wire.rows))
    reply.rows.push_back(reader.text("row", row, kMaxPageBytes));
  reply.next_cursor = reader.text("next_cursor", wire.next_cursor, kMaxCursorBytes);
  reply.message = reader.text("message", wire.message, kMaxMessageBytes);
  reply.last_row_continues = wire.last_row_continues;
  reply.retry_after = read_retry_after(wire.retry_after_ms);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(reply))
    return *error;
  return reply;
}

}  // namespace kinship::codec
