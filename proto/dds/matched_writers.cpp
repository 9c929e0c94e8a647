#include "proto/dds/matched_writers.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <regex>
#include <utility>
#include <vector>

#include "proto/dds/endpoint.hpp"
#include "proto/dds/network_interface.hpp"
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

bool is_own(const std::string& address) {
  if (address.starts_with("127."))
    return true;
  const std::vector<NetworkInterface> interfaces = network_interfaces();
  return std::ranges::any_of(interfaces, [&](const NetworkInterface& each) {
    return std::ranges::find(each.addresses, address) != each.addresses.end();
  });
}

}  // namespace

bool are_own_addresses(const std::string& addresses) {
  if (addresses == "localprocess")
    return true;
  static const std::regex address(R"((\d+\.\d+\.\d+\.\d+):\d+)");
  const std::sregex_iterator begin(addresses.begin(), addresses.end(), address), end;
  return begin != end &&
         std::all_of(begin, end, [](const std::smatch& found) { return is_own(found[1]); });
}

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

void MatchedWriters::forget_heard() {
  for (auto& [writer, sender] : known_)
    if (sender.hearing == Hearing::Heard)
      sender.hearing = Hearing::Unknown;
}

std::optional<Sender> MatchedWriters::look_up(const Entity& reader, std::uint64_t writer) const {
  const Endpoint endpoint(dds_get_matched_publication_data(reader.get(), writer));
  if (!endpoint)
    return std::nullopt;
  const bool is_here = is_local(endpoint->participant_instance_handle);
  if (!has_security_)
    return Sender{.client = text_of(endpoint->participant_key),
                  .is_local = is_here,
                  .participant = endpoint->participant_instance_handle};
  const std::optional<std::string> name = client_of_partitions(endpoint->qos);
  if (!name)
    return std::nullopt;
  return Sender{.client = security::client_of(*name),
                .name = *name,
                .is_local = is_here,
                .participant = endpoint->participant_instance_handle};
}

bool MatchedWriters::is_local(std::uint64_t participant) const {
  std::array<void*, 1> samples{};
  std::array<dds_sample_info_t, 1> infos{};
  const dds_return_t count =
      dds_read_instance(participants_.get(), samples.data(), infos.data(), 1, 1, participant);
  if (count < 1)
    return false;
  bool is_here = false;
  if (infos[0].valid_data) {
    const auto& data = *static_cast<const dds_builtintopic_participant_t*>(samples[0]);
    char* addresses = nullptr;
    if (dds_qget_prop(data.qos, "__NetworkAddresses", &addresses)) {
      is_here = are_own_addresses(addresses);
      dds_free(addresses);
    }
  }
  dds_return_loan(participants_.get(), samples.data(), count);
  return is_here;
}

}  // namespace kinship::dds
