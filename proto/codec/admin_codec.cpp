#include "proto/codec/admin_codec.hpp"

#include "proto/codec/fields.hpp"

namespace kinship::codec {
namespace {

std::optional<Error> validate(const AdminReply& reply) {
  Rules rules;
  check_fields(reply, rules);
  rules.that(!reply.last_row_continues || (!reply.rows.empty() && !reply.next_cursor.empty()),
             "last_row_continues: without a row or a next page");
  std::size_t bytes = 0;
  for (const std::string& row : reply.rows)
    bytes += row.size();
  return rules.at_most("rows (bytes)", bytes, kMaxPageBytes).broken();
}

}  // namespace

Result<Message<kinship_wire_AdminRequest>> encode(const Head& head, const AdminRequest& request) {
  return encode_fields(request, Message<kinship_wire_AdminRequest>(head));
}

Result<AdminRequest> decode(const kinship_wire_AdminRequest& wire) {
  return decode_fields<AdminRequest>(wire);
}

Result<Message<kinship_wire_AdminReply>> encode(const Head& head, const AdminReply& reply) {
  return encode_fields(reply, Message<kinship_wire_AdminReply>(head), validate);
}

Result<AdminReply> decode(const kinship_wire_AdminReply& wire) {
  return decode_fields<AdminReply>(wire, validate);
}

}  // namespace kinship::codec
