#include "proto/codec/report_codec.hpp"

#include "proto/codec/fields.hpp"
#include "proto/codec/retry_after.hpp"
#include "proto/codec/scene_codec.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::codec {
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
  for (std::size_t i = 0; i < numbers.size() && !reader.rules.broken(); ++i)
    if (!std::isfinite(numbers[i]))
      reader.rules.that(false, "waypoint " + std::to_string(i / wire.dof + 1) + ", joint " +
                                   std::to_string(i % wire.dof + 1) + ": " +
                                   number_text(numbers[i]) + " is not finite");
  if (reader.rules.broken())
    return std::nullopt;
  return Path(Eigen::Map<const Eigen::MatrixXd>(numbers.data(), wire.dof,
                                                static_cast<Eigen::Index>(count)));
}

void write_attempt(const Attempt& attempt, Arena& arena, kinship_wire_Attempt& wire) {
  write_uuid(attempt.report_uuid, wire.report_uuid);
  write_digest(attempt.robot, wire.robot);
  wire.machine = arena.text(attempt.machine);
  wire.task = arena.text(attempt.task);
  write_placement(arena, attempt.T_task_base, wire.T_task_base);
  arena.resize(wire.record, 1);
  write_fields(attempt.record, arena, wire.record._buffer[0]);
  if (attempt.scene) {
    arena.resize(wire.scene, 1);
    write_scene(*attempt.scene, arena, wire.scene._buffer[0]);
  }
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
  attempt.machine = reader.text("machine", wire.machine, kMaxMachineBytes);
  attempt.task = reader.text("task", wire.task, kMaxTaskBytes);
  attempt.T_task_base = reader.placement("T_task_base", elements(wire.T_task_base));
  if (const auto record = elements(wire.record); !record.empty())
    attempt.record = read_fields<PlanningRecord>(record[0], reader);
  else
    reader.rules.that(false, "record: is missing");
  attempt.path = read_path(wire, reader);
  if (const auto scene = elements(wire.scene); !scene.empty() && !reader.rules.broken())
    attempt.scene = read_scene(scene[0], reader);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(attempt))
    return *error;
  return attempt;
}

BatchBytes batch_bytes(const kinship_wire_Attempt& wire) {
  BatchBytes bytes{sizeof(double) * elements(wire.waypoints).size(), 0};
  for (const kinship_wire_RecordedScene& scene : elements(wire.scene))
    bytes.scenes += scene_bytes(scene);
  return bytes;
}

void check_token(std::string_view what, std::size_t bytes, Rules& rules) {
  rules.at_most(what, bytes, kMaxConsistencyTokenBytes);
}

void write_token(const ConsistencyToken& token, Arena& arena, dds_sequence_octet& wire) {
  arena.resize(wire, token.size());
  std::copy(token.begin(), token.end(), wire._buffer);
}

ConsistencyToken read_token(const dds_sequence_octet& wire) {
  const auto bytes = elements(wire);
  return {bytes.begin(), bytes.end()};
}

void check_batch(const BatchBytes& bytes, Rules& rules) {
  rules.at_most("waypoints of a batch (bytes)", bytes.waypoints, kMaxBatchBytes)
      .at_most("scenes of a batch (bytes)", bytes.scenes, kMaxSceneBytes);
}

}  // namespace

Result<Message<kinship_wire_ReportRequest>> encode(const Head& head, const ReportRequest& request) {
  Rules rules;
  rules.at_most("attempts of a batch", request.attempts.size(), kMaxAttemptsPerBatch);
  check_token("known_token", request.known_token.size(), rules);
  BatchBytes bytes;
  for (const Attempt& attempt : request.attempts) {
    rules.name(validate(attempt));
    bytes = bytes + batch_bytes(attempt);
  }
  check_batch(bytes, rules);
  if (rules.broken())
    return *rules.broken();
  Message<kinship_wire_ReportRequest> message(head);
  message.arena->resize(message.wire.attempts, request.attempts.size());
  for (std::size_t i = 0; i < request.attempts.size(); ++i)
    write_attempt(request.attempts[i], *message.arena, message.wire.attempts._buffer[i]);
  write_token(request.known_token, *message.arena, message.wire.known_token);
  return limited(std::move(message));
}

Result<ReportRequest> decode(const kinship_wire_ReportRequest& wire) {
  const auto attempts = elements(wire.attempts);
  Rules rules;
  rules.at_most("attempts of a batch", attempts.size(), kMaxAttemptsPerBatch);
  check_token("known_token", elements(wire.known_token).size(), rules);
  if (rules.broken())
    return *rules.broken();
  ReportRequest request;
  request.known_token = read_token(wire.known_token);
  request.attempts.reserve(attempts.size());
  BatchBytes bytes;
  for (const kinship_wire_Attempt& entry : attempts) {
    bytes = bytes + batch_bytes(entry);
    Rules batch;
    check_batch(bytes, batch);
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
  Rules rules;
  rules.at_most("receipts", reply.receipts.size(), kMaxAttemptsPerBatch);
  check_token("consistency_token", reply.consistency_token.size(), rules);
  if (rules.broken())
    return *rules.broken();
  Message<kinship_wire_ReportReply> message(head);
  write_uuid(reply.store_epoch, message.wire.store_epoch);
  message.arena->resize(message.wire.receipts, reply.receipts.size());
  for (std::size_t i = 0; i < reply.receipts.size(); ++i) {
    const Receipt& receipt = reply.receipts[i];
    kinship_wire_Receipt& wire = message.wire.receipts._buffer[i];
    write_uuid(receipt.report_uuid, wire.report_uuid);
    wire.status = static_cast<std::uint32_t>(receipt.status);
    // One odd message must not hold back the receipts of its neighbours.
    wire.message = message.arena->text(cut_text(receipt.message, kMaxMessageBytes));
  }
  write_token(reply.consistency_token, *message.arena, message.wire.consistency_token);
  message.wire.retry_after_ms = retry_after_ms(reply.retry_after);
  message.wire.message = message.arena->text(cut_text(reply.message, kMaxMessageBytes));
  return limited(std::move(message));
}

Result<ReportReply> decode(const kinship_wire_ReportReply& wire) {
  Reader reader;
  reader.rules.at_most("receipts", wire.receipts._length, kMaxAttemptsPerBatch);
  check_token("consistency_token", elements(wire.consistency_token).size(), reader.rules);
  if (reader.rules.broken())
    return *reader.rules.broken();
  ReportReply reply;
  reply.store_epoch = read_uuid(wire.store_epoch);
  reply.consistency_token = read_token(wire.consistency_token);
  reply.retry_after = read_retry_after(wire.retry_after_ms);
  reply.message = reader.text("message", wire.message, kMaxMessageBytes);
  for (const kinship_wire_Receipt& entry : elements(wire.receipts)) {
    Receipt receipt;
    receipt.report_uuid = read_uuid(entry.report_uuid);
    receipt.status = reader.enumerator("status", entry.status, ReceiptStatus::UnknownRobot);
    receipt.message = reader.text("message", entry.message, kMaxMessageBytes);
    reader.rules.text("message", receipt.message, kMaxMessageBytes);
    reply.receipts.push_back(std::move(receipt));
  }
  if (reader.rules.broken())
    return *reader.rules.broken();
  return reply;
}

}  // namespace kinship::codec
