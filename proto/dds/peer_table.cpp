#include "proto/dds/peer_table.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>

namespace kinship::dds {
namespace {

constexpr std::array<std::uint8_t, 12> kIpv4Prefix = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

/// Longer than Cyclone DDS keeps a participant that is silent, or that has said that it goes.
constexpr std::chrono::seconds kAfterLease{5}, kAfterDeparture{5};

/// So many that the ports of one flood are next to never taken for another client's.
constexpr std::size_t kHashes = std::size_t{1} << 20U;

std::size_t hash_of(const PacketSource& source) {
  constexpr std::size_t kPortStride = 13;  // ports of one address stay apart: 65 536 * 13 < kHashes
  const std::string_view address(reinterpret_cast<const char*>(source.address.data()),
                                 source.address.size());
  return (std::hash<std::string_view>()(address) + source.port * kPortStride) % kHashes;
}

}  // namespace

PacketSource PacketSource::ipv4(std::array<std::uint8_t, 4> address, std::uint16_t port) {
  PacketSource source{.port = port};
  std::ranges::copy(address, std::ranges::copy(kIpv4Prefix, source.address.begin()).out);
  return source;
}

std::string PacketSource::address_text() const {
  char text[INET6_ADDRSTRLEN] = {};
  const bool is_ipv4 = std::equal(kIpv4Prefix.begin(), kIpv4Prefix.end(), address.begin());
  inet_ntop(is_ipv4 ? AF_INET : AF_INET6, address.data() + (is_ipv4 ? kIpv4Prefix.size() : 0), text,
            sizeof text);
  return text;
}

double TokenBucket::tokens(TimePoint now) const {
  const std::chrono::duration<double> passed = std::max(now, filled_) - filled_;
  return std::min(rate_.burst, tokens_ + rate_.per_s * passed.count());
}

void TokenBucket::take(TimePoint now) {
  tokens_ = tokens(now) - 1;
  filled_ = std::max(now, filled_);
}

/// Participants choose their prefixes: a table that many of one hash would slow down has bounds
/// that keep that short (kMaxPeers, and rates).
std::size_t PeerTable::PrefixHash::operator()(const GuidPrefix& prefix) const {
  std::uint64_t first = 0;
  std::uint32_t last = 0;
  std::memcpy(&first, prefix.data(), sizeof first);
  std::memcpy(&last, prefix.data() + sizeof first, sizeof last);
  return (first ^ (std::uint64_t{last} << 32U | last)) * 0x9e3779b97f4a7c15U;
}

PacketVerdict PeerTable::take(const std::optional<Datagram>& datagram, const PacketSource& source,
                              bool is_local, bool needs_identity, TimePoint now) {
  if (!datagram)
    return PacketVerdict::Broken;
  if (now - swept_ >= std::chrono::seconds(1))
    sweep(now);
  const auto known = peers_.find(datagram->sender);
  if (known != peers_.end() && known->second.expires >= now)
    return take_known(known->second, *datagram, source, is_local, now);
  if (!datagram->announcement || datagram->announcement->is_departure)
    return PacketVerdict::Stranger;
  if (needs_identity && !datagram->announcement->has_identity)
    return PacketVerdict::WithoutIdentity;
  if (known != peers_.end())
    sweep(now);
  return take_newcomer(*datagram, source, is_local, now);
}

PacketVerdict PeerTable::take_known(Entry& entry, const Datagram& datagram,
                                    const PacketSource& source, bool is_local, TimePoint now) {
  if (source.address != entry.peer.source.address && !(is_local && entry.peer.is_local))
    return PacketVerdict::OtherPlace;
  if (datagram.announcement) {
    if (!entry.announcements.has_token(now))
      return PacketVerdict::PeerRate;
    entry.announcements.take(now);
    if (datagram.announcement->is_departure) {
      entry.expires = now + kAfterDeparture;
      if (entry.peer.is_local && !asked_.empty())
        asked_[hash_of(entry.peer.source)] = false;
      return PacketVerdict::Heard;
    }
  }
  entry.expires = now + entry.lease + kAfterLease;
  return PacketVerdict::Heard;
}

PacketVerdict PeerTable::take_newcomer(const Datagram& datagram, const PacketSource& source,
                                       bool is_local, TimePoint now) {
  if (!overall_) {
    overall_.emplace(kOverallRate, now);
    firsts_.emplace(kFirstRate, now);
  }
  const bool is_first = is_local && asks_first(source, now);
  const PacketVerdict verdict = judge_newcomer(source, is_local, now);
  if (verdict != PacketVerdict::Heard && (!is_first || verdict == PacketVerdict::PortRate ||
                                          peers_here_ >= kMaxPeersHere || !firsts_->has_token(now)))
    return verdict;
  // Only who is admitted gets buckets: their number grows no faster than these refill.
  const Bounds& bounds = is_local ? kBoundsHere : kBoundsElsewhere;
  const Address address = address_of({source, is_local});
  OfAddress& of_address =
      by_address_.try_emplace(address, OfAddress{{bounds.address, now}}).first->second;
  by_port_.try_emplace({source.address, source.port}, bounds.port, now).first->second.take(now);
  (verdict == PacketVerdict::Heard ? of_address.newcomers : *firsts_).take(now);
  ++of_address.peers;
  if (is_local)
    ++peers_here_;
  else
    overall_->take(now);
  const std::chrono::seconds lease = std::min(datagram.announcement->lease, kMaxLease);
  Entry entry{{source, is_local}, lease, now + lease + kAfterLease, {kPeerRate, now}};
  entry.announcements.take(now);
  peers_.emplace(datagram.sender, entry);
  return PacketVerdict::Heard;
}

PacketVerdict PeerTable::judge_newcomer(const PacketSource& source, bool is_local,
                                        TimePoint now) const {
  if (!is_local && peers_.size() - peers_here_ >= kMaxPeersElsewhere)
    return PacketVerdict::Full;
  const auto address = by_address_.find(address_of({source, is_local}));
  if (address != by_address_.end()) {
    if (address->second.peers >= (is_local ? kBoundsHere : kBoundsElsewhere).peers)
      return PacketVerdict::AddressFull;
    const auto port = by_port_.find({source.address, source.port});
    if (port != by_port_.end() && !port->second.has_token(now))
      return PacketVerdict::PortRate;
    if (!address->second.newcomers.has_token(now))
      return PacketVerdict::AddressRate;
  }
  return is_local || overall_->has_token(now) ? PacketVerdict::Heard : PacketVerdict::OverallRate;
}

/// Whether no newcomer has asked from this address and port of this machine for half a minute, but
/// those that have said that they go.
bool PeerTable::asks_first(const PacketSource& source, TimePoint now) {
  if (asked_.empty() || now - cleared_ >= std::chrono::seconds(30)) {
    cleared_ = now;
    asked_.assign(kHashes, false);
  }
  const std::size_t hash = hash_of(source);
  const bool is_first = !asked_[hash];
  asked_[hash] = true;
  return is_first;
}

/// The address that a participant counts for.
PeerTable::Address PeerTable::address_of(const Peer& peer) {
  return peer.is_local ? Address{} : peer.source.address;
}

void PeerTable::sweep(TimePoint now) {
  swept_ = now;
  std::erase_if(peers_, [&](const auto& each) {
    if (each.second.expires >= now)
      return false;
    --by_address_.at(address_of(each.second.peer)).peers;
    peers_here_ -= each.second.peer.is_local ? 1 : 0;
    return true;
  });
  std::erase_if(by_port_, [&](const auto& each) { return each.second.is_full(now); });
  std::erase_if(by_address_, [&](const auto& each) {
    return each.second.peers == 0 && each.second.newcomers.is_full(now);
  });
}

std::optional<PeerTable::Peer> PeerTable::find(const GuidPrefix& prefix) const {
  const auto known = peers_.find(prefix);
  return known == peers_.end() ? std::nullopt : std::optional(known->second.peer);
}

}  // namespace kinship::dds
