#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/dds/peer_table.hpp"

namespace kinship::dds {

/// While one lives, every datagram that Cyclone DDS reads in this process goes by a PeerTable
/// first: a participant is heard from one place only, newcomers are admitted at bounded rates, and
/// its lease is at most PeerTable::kMaxLease. Cyclone DDS 0.10.2 takes any number of announcements
/// with any lease, and who is where from what they say. May be shared between threads.
///
/// For the whole process: a datagram does not say for which domain it is.
class PacketGuard {
 public:
  /// \param needs_identity  whether a newcomer has to name a certificate, as with security.
  /// \throws Failure(InvalidInput) if Cyclone DDS does not ask this library: a program loaded
  ///         Cyclone DDS before this library, or has another copy of this library.
  explicit PacketGuard(bool needs_identity);
  PacketGuard(const PacketGuard&) = delete;
  PacketGuard& operator=(const PacketGuard&) = delete;
  ~PacketGuard();

 private:
  bool needs_identity_;
};

/// Where a remote participant's packets come from; nothing if it is not known.
std::optional<PeerTable::Peer> find_peer(const GuidPrefix& prefix);

/// Datagrams that were dropped for one reason, since the process began.
struct DroppedPackets {
  std::string_view reason;  ///< in words, e.g. "announcements beyond a port's rate"
  std::uint64_t count = 0;
  std::string last_source;   ///< "10.0.0.9:4711"
  std::int64_t last_ms = 0;  ///< Unix time
};

/// One for each reason, also those that never occurred.
std::vector<DroppedPackets> dropped_packets();

/// Remote participants that are known now.
std::size_t known_peers();

}  // namespace kinship::dds
