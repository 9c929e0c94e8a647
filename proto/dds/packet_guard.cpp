#include "proto/dds/packet_guard.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_guid.h>
#include <dds/ddsi/ddsi_plist.h>
#include <dds/ddsrt/sockets.h>
#include <dlfcn.h>
#include <netinet/in.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>

#include "proto/dds/binding.hpp"
#include "proto/dds/network_interface.hpp"
#include "proto/dds/steady_waits.hpp"
#include "proto/types/failure.hpp"

// Of dds/ddsi/ddsi_proxy_participant.h and q_addrset.h, which are no C++.
struct addrset;
extern "C" void unref_addrset(addrset* addresses);

namespace kinship::dds {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<std::string_view, kPacketVerdicts> kReasons = {
    "",
    "packets that are broken",
    "announcements without a certificate",
    "packets of participants unknown",
    "packets from another place",
    "newcomers beyond a port's rate",
    "newcomers beyond an address's rate",
    "newcomers beyond the rate of all",
    "announcements beyond a participant's",
    "newcomers beyond an address's number",
    "newcomers beyond the number of all"};

/// The addresses of this machine, read again once a second at most.
class OwnAddresses {
 public:
  bool has(const std::string& address, Clock::time_point now) {
    if (address.starts_with("127."))
      return true;
    if (now - read_ >= std::chrono::seconds(1)) {
      interfaces_ = network_interfaces();
      read_ = now;
    }
    return std::ranges::any_of(interfaces_, [&](const NetworkInterface& each) {
      return std::ranges::find(each.addresses, address) != each.addresses.end();
    });
  }

 private:
  std::vector<NetworkInterface> interfaces_;
  Clock::time_point read_{};
};

/// The table and what was dropped. May be shared between threads.
class GuardedPeers {
 public:
  /// Takes out of the bytes of a datagram what is not to be heard: the parts of some senders, or
  /// all. \return the size of the rest, B; 0 if nothing is to be heard.
  std::size_t filter(std::span<std::uint8_t> bytes, const PacketSource& source,
                     bool needs_identity) {
    const std::optional<Datagram> datagram = read_datagram(bytes);
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    bool is_any_heard = take(datagram, source, needs_identity, now);
    if (!datagram)
      return 0;
    std::size_t size = is_any_heard ? datagram->end : datagram->begin;
    for (const Datagram& other : datagram->others) {
      if (!take(other, source, needs_identity, now))
        continue;
      is_any_heard = true;
      const auto part = bytes.subspan(other.begin, other.end - other.begin);
      std::memmove(bytes.data() + size, part.data(), part.size());
      size += part.size();
    }
    return is_any_heard ? size : 0;
  }

  std::optional<PeerTable::Peer> find(const GuidPrefix& prefix) {
    const std::lock_guard lock(mutex_);
    return table_.find(prefix);
  }

  std::size_t size() {
    const std::lock_guard lock(mutex_);
    return table_.size();
  }

  std::vector<DroppedPackets> dropped() {
    const std::lock_guard lock(mutex_);
    std::vector<DroppedPackets> all;
    for (std::size_t i = 1; i < kReasons.size(); ++i) {
      const Dropped& each = dropped_.at(i);
      DroppedPackets row{.reason = kReasons.at(i), .count = each.count};
      if (each.count > 0) {
        row.last_source = each.source.address_text() + ':' + std::to_string(each.source.port);
        row.last_ms =
            std::chrono::floor<std::chrono::milliseconds>(each.time).time_since_epoch().count();
      }
      all.push_back(row);
    }
    return all;
  }

  void forget_peers() {
    const std::lock_guard lock(mutex_);
    table_ = {};
  }

 private:
  struct Dropped {
    std::uint64_t count = 0;
    PacketSource source;
    std::chrono::system_clock::time_point time;
  };

  /// With mutex_ held. An address is looked up for newcomers, and for who is heard from a second
  /// one.
  bool take(const std::optional<Datagram>& datagram, const PacketSource& source,
            bool needs_identity, Clock::time_point now) {
    const bool is_local = datagram && is_own(*datagram, source, now);
    const PacketVerdict verdict = table_.take(datagram, source, is_local, needs_identity, now);
    if (verdict == PacketVerdict::Heard)
      return true;
    Dropped& dropped = dropped_.at(static_cast<std::size_t>(verdict));
    ++dropped.count;
    dropped.source = source;
    dropped.time = std::chrono::system_clock::now();
    return false;
  }

  bool is_own(const Datagram& datagram, const PacketSource& source, Clock::time_point now) {
    const auto known = table_.find(datagram.sender);
    if (known && known->source.address == source.address)
      return known->is_local;
    if (!known && !datagram.announcement)
      return false;
    return own_.has(source.address_text(), now);
  }

  std::mutex mutex_;  // guards what follows
  PeerTable table_;
  OwnAddresses own_;
  std::array<Dropped, kPacketVerdicts> dropped_;
};

/// Never destroyed: threads of Cyclone DDS may read until the process ends.
GuardedPeers& peers() {
  static auto* const all = new GuardedPeers;
  return *all;
}

std::atomic<int> packet_guards = 0;          // that live
std::atomic<int> packet_guards_secured = 0;  // of these

PacketSource source_of(const msghdr& message) {
  PacketSource source;
  sockaddr_storage address{};
  const std::size_t size = std::min<std::size_t>(message.msg_namelen, sizeof address);
  if (message.msg_name == nullptr)
    return source;
  std::memcpy(&address, message.msg_name, size);
  if (address.ss_family == AF_INET && size >= sizeof(sockaddr_in)) {
    sockaddr_in own{};
    std::memcpy(&own, &address, sizeof own);
    std::array<std::uint8_t, 4> bytes{};
    std::memcpy(bytes.data(), &own.sin_addr, sizeof bytes);
    return PacketSource::ipv4(bytes, ntohs(own.sin_port));
  }
  if (address.ss_family == AF_INET6 && size >= sizeof(sockaddr_in6)) {
    sockaddr_in6 own{};
    std::memcpy(&own, &address, sizeof own);
    std::memcpy(source.address.data(), &own.sin6_addr, source.address.size());
    source.port = ntohs(own.sin6_port);
  }
  return source;
}

/// What Cyclone DDS may see of a datagram of this size, B. Its caller is C: nothing is thrown, and
/// without memory the datagram is lost, as datagrams may be.
ssize_t admitted_size(const msghdr& message, ssize_t size) noexcept try {
  if (packet_guards == 0 || size <= 0 || message.msg_iovlen != 1)
    return size;
  const iovec& buffer = message.msg_iov[0];
  const std::size_t read = std::min<std::size_t>(static_cast<std::size_t>(size), buffer.iov_len);
  const std::size_t rest = peers().filter({static_cast<std::uint8_t*>(buffer.iov_base), read},
                                          source_of(message), packet_guards_secured > 0);
  return rest == read ? size : static_cast<ssize_t>(rest);
} catch (...) {
  return 0;
}

/// Whether packets of this participant have been heard; Cyclone DDS also makes participants of
/// what others say about them.
bool has_announced_itself(const ddsi_guid& guid) {
  GuidPrefix prefix{};
  static_assert(sizeof guid.prefix == sizeof prefix);
  for (std::size_t i = 0; i < std::size(guid.prefix.u); ++i) {
    const std::uint32_t word = htonl(guid.prefix.u[i]);
    std::memcpy(prefix.data() + i * sizeof word, &word, sizeof word);
  }
  return peers().find(prefix).has_value();
}

}  // namespace

std::optional<PeerTable::Peer> find_peer(const GuidPrefix& prefix) { return peers().find(prefix); }
std::vector<DroppedPackets> dropped_packets() { return peers().dropped(); }
std::size_t known_peers() { return peers().size(); }

}  // namespace kinship::dds

/// In front of the function of this name in Cyclone DDS, which reads each of its datagrams: a
/// program's own symbols come before those of libraries. What is dropped looks like an error that
/// Cyclone DDS passes over: an earlier packet of ours met a closed port.
extern "C" __attribute__((visibility("default"))) dds_return_t ddsrt_recvmsg(
    ddsrt_socket_t socket, ddsrt_msghdr_t* message, int flags, ssize_t* received) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsrt_recvmsg)>(
      dlsym(RTLD_NEXT, "ddsrt_recvmsg"));  // NOLINT: what dlsym is for
  const dds_return_t result = kBehind(socket, message, flags, received);
  if (result != DDS_RETCODE_OK || *received <= 0)
    return result;
  *received = kinship::dds::admitted_size(*message, *received);
  return *received > 0 ? result : DDS_RETCODE_NO_CONNECTION;
}

/// In front of the function of this name in Cyclone DDS, which is called for each remote
/// participant that it begins to hear, and also for what its packets say of others. Each has its
/// own lease, and depends on no other participant (`privileged`).
// NOLINTNEXTLINE(readability-function-size): its parameters are Cyclone DDS's
extern "C" __attribute__((visibility("default"))) bool ddsi_new_proxy_participant(
    ddsi_domaingv* domain, const ddsi_guid* guid, std::uint32_t endpoints,
    const ddsi_guid* privileged, addrset* data_addresses, addrset* discovery_addresses,
    const ddsi_plist* announced, dds_duration_t lease, nn_vendorid_t vendor, unsigned flags,
    ddsrt_wctime_t time, seqno_t sequence_number) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsi_new_proxy_participant)>(
      dlsym(RTLD_NEXT, "ddsi_new_proxy_participant"));  // NOLINT: what dlsym is for
  constexpr dds_duration_t kMaxLease =
      std::chrono::nanoseconds(kinship::dds::PeerTable::kMaxLease).count();
  if (kinship::dds::packet_guards > 0) {
    if (!kinship::dds::has_announced_itself(*guid)) {
      unref_addrset(data_addresses);
      unref_addrset(discovery_addresses);
      return false;
    }
    lease = std::min(lease, kMaxLease);
    privileged = nullptr;
  }
  return kBehind(domain, guid, endpoints, privileged, data_addresses, discovery_addresses,
                 announced, lease, vendor, flags, time, sequence_number);
}

namespace kinship::dds {

PacketGuard::PacketGuard(bool needs_identity) : needs_identity_(needs_identity) {
  const auto is_in_front = [](const char* name, auto* function) {
    return is_in_front_of_cyclone(name, reinterpret_cast<void*>(function));  // NOLINT: as above
  };
  if (!is_in_front("ddsrt_recvmsg", &ddsrt_recvmsg) ||
      !is_in_front("ddsi_new_proxy_participant", &ddsi_new_proxy_participant) ||
      !are_waits_steady())
    throw Failure(ErrorCode::InvalidInput,
                  "cannot serve: this process loaded Cyclone DDS (libddsc), or another copy of "
                  "Kinship, first, so that what Kinship checks about packets would not be asked; "
                  "load Kinship before it");
  packet_guards_secured += needs_identity_ ? 1 : 0;
  ++packet_guards;
}

PacketGuard::~PacketGuard() {
  packet_guards_secured -= needs_identity_ ? 1 : 0;
  if (--packet_guards == 0)
    peers().forget_peers();
}

}  // namespace kinship::dds
