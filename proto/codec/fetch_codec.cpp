#include "proto/codec/fetch_codec.hpp"

#include "proto/codec/distribution_codec.hpp"
#include "proto/codec/experience_codec.hpp"
#include "proto/codec/fields.hpp"
#include "proto/codec/recall_codec.hpp"
#include "proto/codec/rehearsal_codec.hpp"
#include "proto/codec/selection_codec.hpp"

namespace kinship::codec {

template <>
struct WireMember<Selection> {
  using Type = SelectionMember;
};
template <>
struct WireMember<std::optional<Distribution>> {
  using Type = decltype(kinship_wire_FetchReply::distribution);
};
template <>
struct WireMember<std::optional<TaskExperience>> {
  using Type = decltype(kinship_wire_FetchReply::experience);
};
template <>
struct WireMember<std::optional<Rehearsal>> {
  using Type = decltype(kinship_wire_FetchReply::rehearsal);
};
template <>
struct WireMember<std::optional<RecallLibrary>> {
  using Type = decltype(kinship_wire_FetchReply::recall);
};

namespace {

std::optional<Error> validate(const FetchReply& reply) {
  const bool may_have_one =
      reply.status == FetchStatus::Ready || reply.status == FetchStatus::Failed;
  Rules rules;
  rules.that(
      reply.distribution.has_value() == may_have_one,
      may_have_one ? "distribution: missing" : "distribution: not expected with this status");
  check_fields(reply, rules);
  if (reply.distribution)
    rules.name(codec::validate(*reply.distribution));
  if (reply.experience)
    rules.name(codec::validate(*reply.experience));
  if (reply.rehearsal)
    rules.name(codec::validate(*reply.rehearsal));
  if (reply.recall)
    rules.name(kinship::validate(*reply.recall));
  return rules.broken();
}

}  // namespace

std::optional<Error> validate(const FetchRequest& request) {
  Rules rules;
  check_fields(request, rules);
  rules.not_empty("profile", request.profile)
      .that(!request.rehearsed || request.experience_bytes > 0,
            "rehearsed: without experience_bytes");
  return check_selection(request.selection, rules).broken();
}

Result<Message<kinship_wire_FetchRequest>> encode(const Head& head, const FetchRequest& request) {
  return encode_fields(request, Message<kinship_wire_FetchRequest>(head), validate);
}

Result<FetchRequest> decode(const kinship_wire_FetchRequest& wire) {
  return decode_fields<FetchRequest>(wire, validate);
}

Result<Message<kinship_wire_FetchReply>> encode(const Head& head, const FetchReply& reply) {
  return encode_fields(reply, Message<kinship_wire_FetchReply>(head), validate);
}

Result<FetchReply> decode(const kinship_wire_FetchReply& wire) {
  return decode_fields<FetchReply>(wire, validate);
}

}  // namespace kinship::codec
