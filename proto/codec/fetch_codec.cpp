#include "proto/codec/fetch_codec.hpp"

#include <limits>

#include "proto/codec/distribution_codec.hpp"
#include "proto/codec/experience_codec.hpp"
#include "proto/codec/reader.hpp"
#include "proto/codec/rehearsal_codec.hpp"
#include "proto/codec/selection_codec.hpp"
#include "proto/codec/writer.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {
namespace {

constexpr double kMaxMilliseconds = std::numeric_limits<std::uint32_t>::max();

std::optional<Error> validate(const FetchReply& reply) {
  const bool may_have_one =
      reply.status == FetchStatus::Ready || reply.status == FetchStatus::Failed;
  Rules rules;
  rules
      .that(reply.distribution.has_value() == may_have_one,
            may_have_one ? "distribution: missing" : "distribution: not expected with this status")
      .between("retry_after (ms)", static_cast<double>(reply.retry_after.count()), 0,
               kMaxMilliseconds)
      .text("message", reply.message, kMaxMessageBytes);
  if (reply.distribution)
    rules.name(codec::validate(*reply.distribution));
  if (reply.experience)
    rules.name(codec::validate(*reply.experience));
  if (reply.rehearsal)
    rules.name(codec::validate(*reply.rehearsal));
  return rules.broken();
}

}  // namespace

std::optional<Error> validate(const FetchRequest& request) {
  Rules rules;
  rules.name(check_task(request.task))
      .not_empty("profile", request.profile)
      .text("profile", request.profile, kMaxProfileBytes)
      .between("deadline (ms)", static_cast<double>(request.deadline.count()), 0,
               static_cast<double>(kMaxFetchDeadline_ms));
  rules
      .between("follow (s)", static_cast<double>(request.follow.count()), 0,
               static_cast<double>(kMaxFollow_s))
      .between("experience_bytes", request.experience_bytes, 0, kMaxExperienceBytes)
      .that(!request.rehearsed || request.experience_bytes > 0,
            "rehearsed: without experience_bytes");
  if (request.T_task_base)
    rules.pose("T_task_base", *request.T_task_base);
  return check_selection(request.selection, rules).broken();
}

Result<Message<kinship_wire_FetchRequest>> encode(const Head& head, const FetchRequest& request) {
  if (const auto error = validate(request))
    return *error;
  Message<kinship_wire_FetchRequest> message(head);
  Arena& arena = *message.arena;
  auto& wire = message.wire;
  wire.task = arena.text(request.task);
  write_digest(request.robot, wire.robot);
  write_placement(arena, request.T_task_base, wire.T_task_base);
  wire.profile = arena.text(request.profile);
  wire.minimum_generation = request.minimum_generation;
  wire.deadline_ms = static_cast<std::uint32_t>(request.deadline.count());
  write_selection(request.selection, arena, wire.selection);
  wire.follow_s = static_cast<std::uint32_t>(request.follow.count());
  wire.experience_bytes = request.experience_bytes;
  wire.known_experience = request.known_experience;
  wire.rehearsed = request.rehearsed;
  return message;
}

Result<FetchRequest> decode(const kinship_wire_FetchRequest& wire) {
  Reader reader;
  FetchRequest request;
  request.task = reader.text("task", wire.task, kMaxTaskBytes);
  request.robot = read_digest(wire.robot);
  request.T_task_base = reader.placement("T_task_base", elements(wire.T_task_base));
  request.profile = reader.text("profile", wire.profile, kMaxProfileBytes);
  request.minimum_generation = wire.minimum_generation;
  request.deadline = std::chrono::milliseconds(wire.deadline_ms);
  request.selection = read_selection(wire.selection, reader);
  request.follow = std::chrono::seconds(wire.follow_s);
  request.experience_bytes = wire.experience_bytes;
  request.known_experience = wire.known_experience;
  request.rehearsed = wire.rehearsed;
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(request))
    return *error;
  return request;
}

Result<Message<kinship_wire_FetchReply>> encode(const Head& head, const FetchReply& reply) {
  if (const auto error = validate(reply))
    return *error;
  Message<kinship_wire_FetchReply> message(head);
  Arena& arena = *message.arena;
  auto& wire = message.wire;
  wire.status = static_cast<std::uint32_t>(reply.status);
  if (reply.distribution) {
    arena.resize(wire.distribution, 1);
    write_distribution(*reply.distribution, arena, wire.distribution._buffer[0]);
  }
  wire.retry_after_ms = static_cast<std::uint32_t>(reply.retry_after.count());
  wire.message = arena.text(reply.message);
  if (reply.experience) {
    arena.resize(wire.experience, 1);
    write_experience(*reply.experience, arena, wire.experience._buffer[0]);
  }
  if (reply.rehearsal) {
    arena.resize(wire.rehearsal, 1);
    write_rehearsal(*reply.rehearsal, arena, wire.rehearsal._buffer[0]);
  }
  return limited(std::move(message));
}

Result<FetchReply> decode(const kinship_wire_FetchReply& wire) {
  Reader reader;
  FetchReply reply;
  reply.status = reader.enumerator("status", wire.status, FetchStatus::Failed);
  reply.retry_after = std::chrono::milliseconds(wire.retry_after_ms);
  reply.message = reader.text("message", wire.message, kMaxMessageBytes);
  if (const auto distribution = elements(wire.distribution); !distribution.empty())
    reply.distribution = read_distribution(distribution[0], reader);
  if (const auto experience = elements(wire.experience); !experience.empty())
    reply.experience = read_experience(experience[0], reader);
  if (const auto rehearsal = elements(wire.rehearsal); !rehearsal.empty())
    reply.rehearsal = read_rehearsal(rehearsal[0], reader);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(reply))
    return *error;
  return reply;
}

}  // namespace kinship::codec
