#pragma once

#include <optional>
#include <string>

struct dds_qos;

namespace kinship::dds {

/// What a client's participant says of itself in its user data, so that people recognise it.
/// Anybody may say anything: it decides nothing.
struct SelfDescription {
  std::string host;
  std::string program;
};

/// Of this process. Bytes that are not printable ASCII are left out.
SelfDescription own_description();

/// Adds a description to the QoS of a participant.
void set_description(dds_qos* qos, const SelfDescription& self);

/// \return the description that a participant's QoS has, cut to its limits; nothing if there is
/// none.
std::optional<SelfDescription> self_description_of(const dds_qos* qos);

}  // namespace kinship::dds
