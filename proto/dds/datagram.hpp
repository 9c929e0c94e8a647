#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kinship::dds {

/// The first 12 bytes of the GUID of a participant and of all its readers and writers.
using GuidPrefix = std::array<std::uint8_t, 12>;

/// A participant's announcement of itself (SPDP).
struct ParticipantAnnouncement {
  bool is_departure = false;  ///< the participant ends
  bool has_identity = false;  ///< it names a certificate, as participants with security do
  std::chrono::seconds
      lease{};  ///< after which a silent participant is gone, rounded up; at most a day
};

/// A datagram of RTPS, as far as its sender and the sender's announcement tell.
struct Datagram {
  GuidPrefix sender{};
  std::optional<ParticipantAnnouncement> announcement;
  /// Further senders, after INFO_SRC: Cyclone DDS packs what the participants of a process send.
  std::vector<Datagram> others = {};
  std::size_t begin = 0, end = 0;  ///< its part of the bytes, without the header
};

/// Reads hostile bytes: every length is checked. Understands the framing of RTPS 2.1 and later as
/// Cyclone DDS 0.10.2 does.
/// \return nothing for a datagram that no participant of ours sends and that is not to be heard:
///         broken, of too many senders, with an announcement that is broken, cut in pieces
///         (DATA_FRAG), in more than two copies, or about another participant than its sender; with
///         an announcement or the end of an endpoint, or a sign of life, of another participant
///         than its sender, or of a DDSI2 service, on whose lease Cyclone DDS makes others depend.
std::optional<Datagram> read_datagram(std::span<const std::uint8_t> bytes);

}  // namespace kinship::dds
