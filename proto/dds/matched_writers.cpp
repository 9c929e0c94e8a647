#include "proto/dds/matched_writers.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "proto/dds/endpoint.hpp"
#include "proto/dds/packet_guard.hpp"
#include "proto/dds/self_description.hpp"
#include "proto/security/certificate_name.hpp"
#include "proto/security/permissions.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::dds {
namespace {

constexpr std::size_t kMaxKnown = 4096;  // then all are looked up anew

std::string text_of(const dds_guid_t& guid) {
  Uuid uuid;
  std::copy(std::begin(guid.v), std::end(guid.v), uuid.bytes.begin());
  return uuid.text();
}

/// Of what an entity has matched: all, or nothing after an error or if they are too many.
template <typename Get>
std::optional<std::vector<dds_instance_handle_t>> matched(const Entity& entity, const Get& get) {
  std::vector<dds_instance_handle_t> handles(kMaxKnown);
  const dds_return_t count = get(entity.get(), handles.data(), handles.size());
  if (count < 0 || static_cast<std::size_t>(count) > handles.size())
    return std::nullopt;
  handles.resize(static_cast<std::size_t>(count));
  return handles;
}

GuidPrefix prefix_of(const dds_guid_t& guid) {
  GuidPrefix prefix;
  std::copy_n(std::begin(guid.v), prefix.size(), prefix.begin());
  return prefix;
}

}  // namespace

std::optional<std::string> client_of_partitions(const dds_qos* qos) {
  std::uint32_t count = 0;
  char** partitions = nullptr;
  if (!dds_qget_partition(qos, &count, &partitions))
    return std::nullopt;
  std::optional<std::string> name;
  const std::string prefix = security::client_partition("");
  if (count == 1 && std::string_view(partitions[0]).starts_with(prefix))
    name = partitions[0] + prefix.size();
  for (std::uint32_t i = 0; i < count; ++i)
    dds_free(partitions[i]);
  dds_free(partitions);
  if (!name || !security::read_certificate_name(*name))
    return std::nullopt;
  return name;
}

std::optional<std::set<std::string>> clients_of_readers(const Entity& writer) {
  const auto readers = matched(writer, dds_get_matched_subscriptions);
  if (!readers)
    return std::nullopt;
  std::set<std::string> clients;
  for (const dds_instance_handle_t reader : *readers)
    if (const Endpoint endpoint(dds_get_matched_subscription_data(writer.get(), reader)); endpoint)
      clients.insert(text_of(endpoint->participant_key));
  return clients;
}

MatchedWriters::MatchedWriters(const Participant& participant)
    : has_security_(participant.credentials().has_value()),
      participants_(
          dds_create_reader(participant.get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
          "reader of participants") {}

Sender* MatchedWriters::find(const Entity& reader, std::uint64_t writer) {
  if (const auto known = known_.find(writer); known != known_.end())
    return &known->second;
  std::optional<Sender> sender = look_up(reader, writer);
  if (!sender)
    return nullptr;
  if (known_.size() >= kMaxKnown)
    known_.clear();
  return &known_.emplace(writer, *std::move(sender)).first->second;
}

std::optional<std::set<std::string>> MatchedWriters::clients(const Entity& reader) {
  const auto writers = matched(reader, dds_get_matched_publications);
  if (!writers)
    return std::nullopt;
  std::set<std::string> clients;
  for (const dds_instance_handle_t writer : *writers)
    if (const Sender* const sender = find(reader, writer))
      clients.insert(sender->client);
  return clients;
}

void MatchedWriters::forget_heard() {
  for (auto& [writer, sender] : known_)
    if (sender.hearing == Hearing::Heard)
      sender.hearing = Hearing::Unknown;
}

std::optional<Sender> MatchedWriters::look_up(const Entity& reader, std::uint64_t writer) const {
  const Endpoint endpoint(dds_get_matched_publication_data(reader.get(), writer));
  if (!endpoint)
    return std::nullopt;
  Sender sender{.client = {}, .participant = endpoint->participant_instance_handle};
  if (const auto peer = find_peer(prefix_of(endpoint->participant_key))) {
    sender.is_local = peer->is_local;
    sender.address = peer->source.address_text();
  }
  describe(sender);
  if (!has_security_) {
    sender.client = text_of(endpoint->participant_key);
    return sender;
  }
  const std::optional<std::string> name = client_of_partitions(endpoint->qos);
  if (!name)
    return std::nullopt;
  sender.client = security::client_of(*name);
  sender.name = *name;
  return sender;
}

/// From what its participant announced.
void MatchedWriters::describe(Sender& sender) const {
  std::array<void*, 1> samples{};
  std::array<dds_sample_info_t, 1> infos{};
  const dds_return_t count = dds_read_instance(participants_.get(), samples.data(), infos.data(), 1,
                                               1, sender.participant);
  if (count < 1)
    return;
  if (infos[0].valid_data) {
    const auto& participant = *static_cast<const dds_builtintopic_participant_t*>(samples[0]);
    if (sender.address.empty())
      sender.is_local = is_in_this_process(participant);
    if (!has_security_)
      if (std::optional<SelfDescription> self = self_description_of(participant.qos)) {
        sender.host = std::move(self->host);
        sender.program = std::move(self->program);
      }
  }
  dds_return_loan(participants_.get(), samples.data(), count);
}

}  // namespace kinship::dds
