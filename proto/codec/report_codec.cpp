#include "proto/codec/report_codec.hpp"

#include <stdexcept>

#include "proto/codec/fields.hpp"
#include "proto/codec/scene_codec.hpp"
#include "proto/codec/search_codec.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {

template <>
struct WireMember<std::vector<Receipt>> {
  using Type = decltype(kinship_wire_ReportReply::receipts);
};

namespace {

/// A path from dof and waypoints, or none; sizes are checked before it is made.
std::optional<Path> read_path(const kinship_wire_Attempt& wire, Reader& reader) {
  const auto numbers = elements(wire.waypoints);
  if (numbers.empty() && wire.dof == 0)
    return std::nullopt;
  reader.rules.between("dof", wire.dof, 1, kMaxDof);
  if (reader.rules.broken())
    return std::nullopt;
  const std::size_t count = numbers.size() / wire.dof;
  reader.rules
      .that(count * wire.dof == numbers.size(), "waypoints: " + std::to_string(numbers.size()) +
                                                    " numbers are no multiple of dof " +
                                                    std::to_string(wire.dof))
      .that(count >= 2, "waypoints: " + std::to_string(count) + ", must be at least 2")
      .at_most("waypoints", count, kMaxWaypoints);
  if (reader.rules.broken())
    return std::nullopt;
  try {
    return Path(Eigen::Map<const Eigen::MatrixXd>(numbers.data(), wire.dof,
                                                  static_cast<Eigen::Index>(count)));
  } catch (const std::invalid_argument& error) {  // the class knows its own invariant
    reader.rules.that(false, error.what());
    return std::nullopt;
  }
}

void write_attempt(const Attempt& attempt, Arena& arena, kinship_wire_Attempt& wire) {
  write_uuid(attempt.report_uuid, wire.report_uuid);
  write_digest(attempt.robot, wire.robot);
  wire.machine = arena.text(attempt.machine);
  wire.task = arena.text(attempt.task);
  write_placement(arena, attempt.T_task_base, wire.T_task_base);
  arena.resize(wire.record, 1);
  write_fields(attempt.record, arena, wire.record._buffer[0]);
  write_value(attempt.scene, {}, arena, wire.scene);
  write_value(attempt.search, {}, arena, wire.search);
  if (!attempt.path)
    return;
  const Eigen::MatrixXd& waypoints = attempt.path->waypoints();
  wire.dof = static_cast<std::uint32_t>(waypoints.rows());
  write_numbers(arena, waypoints.data(), static_cast<std::size_t>(waypoints.size()),
                wire.waypoints);
}

Result<Attempt> read_attempt(const kinship_wire_Attempt& wire) {
  Reader reader;
  Attempt attempt;
  attempt.report_uuid = read_uuid(wire.report_uuid);
  attempt.robot = read_digest(wire.robot);
  attempt.machine = read_text(wire.machine);
  attempt.task = read_text(wire.task);
  attempt.T_task_base = reader.placement("T_task_base", elements(wire.T_task_base));
  if (const auto record = elements(wire.record); !record.empty())
    attempt.record = read_fields<PlanningRecord>(record[0], reader);
  else
    reader.rules.that(false, "record: is missing");
  attempt.path = read_path(wire, reader);
  if (!reader.rules.broken())
    attempt.scene = read_value<std::optional<RecordedScene>>({"scene"}, wire.scene, {}, reader);
  if (!reader.rules.broken())
    attempt.search = read_value<std::optional<SearchRecord>>({"search"}, wire.search, {}, reader);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(attempt))
    return *error;
  return attempt;
}

BatchBytes batch_bytes(const kinship_wire_Attempt& wire) {
  BatchBytes bytes{.waypoints = sizeof(double) * elements(wire.waypoints).size()};
  for (const kinship_wire_RecordedScene& scene : elements(wire.scene))
    bytes.scenes += scene_bytes(scene);
  for (const kinship_wire_SearchRecord& search : elements(wire.search))
    bytes.searches += search_bytes(search);
  return bytes;
}

/// Limits of a batch besides those of each attempt.
Rules& check_batch(std::size_t attempts, std::size_t token, Rules& rules) {
  return rules.at_most("attempts of a batch", attempts, kMaxAttemptsPerBatch)
      .at_most("known_token", token, kMaxConsistencyTokenBytes);
}

void check_bytes(const BatchBytes& bytes, Rules& rules) {
  rules.at_most("waypoints of a batch (bytes)", bytes.waypoints, kMaxBatchBytes)
      .at_most("waypoints and searches of a batch (bytes)", bytes.waypoints + bytes.searches,
               kMaxBatchBytes)
      .at_most("scenes of a batch (bytes)", bytes.scenes, kMaxSceneBytes);
}

}  // namespace

Result<Message<kinship_wire_ReportRequest>> encode(const Head& head, const ReportRequest& request) {
  Rules rules;
  check_batch(request.attempts.size(), request.known_token.size(), rules);
  BatchBytes bytes;
  for (const Attempt& attempt : request.attempts)
    bytes = bytes + batch_bytes(attempt);
  check_bytes(bytes, rules);
  if (rules.broken())
    return *rules.broken();
  Message<kinship_wire_ReportRequest> message(head);
  message.arena->resize(message.wire.attempts, request.attempts.size());
  for (std::size_t i = 0; i < request.attempts.size(); ++i)
    write_attempt(request.attempts[i], *message.arena, message.wire.attempts._buffer[i]);
  write_value(request.known_token, {}, *message.arena, message.wire.known_token);
  return limited(std::move(message));
}

Result<ReportRequest> decode(const kinship_wire_ReportRequest& wire) {
  const auto attempts = elements(wire.attempts);
  const auto token = elements(wire.known_token);
  Rules rules;
  if (check_batch(attempts.size(), token.size(), rules).broken())
    return *rules.broken();
  ReportRequest request;
  request.known_token.assign(token.begin(), token.end());
  request.attempts.reserve(attempts.size());
  BatchBytes bytes;
  for (const kinship_wire_Attempt& entry : attempts) {
    bytes = bytes + batch_bytes(entry);
    Rules batch;
    check_bytes(bytes, batch);
    Result<Attempt> attempt =
        batch.broken() ? Result<Attempt>(*batch.broken()) : read_attempt(entry);
    if (attempt)
      request.attempts.push_back(std::move(attempt).value());
    else
      request.refused.push_back(
          {read_uuid(entry.report_uuid), ReceiptStatus::Refused, attempt.error().message});
  }
  return request;
}

Result<Message<kinship_wire_ReportReply>> encode(const Head& head, const ReportReply& reply) {
  ReportReply sent = reply;
  // One odd message must not hold back the receipts of its neighbours.
  for (Receipt& receipt : sent.receipts)
    receipt.message = cut_text(receipt.message, kMaxMessageBytes);
  sent.message = cut_text(reply.message, kMaxMessageBytes);
  return encode_fields(sent, Message<kinship_wire_ReportReply>(head));
}

Result<ReportReply> decode(const kinship_wire_ReportReply& wire) {
  return decode_fields<ReportReply>(wire);
}

}  // namespace kinship::codec
