#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "proto/dds/datagram.hpp"

namespace kinship::dds {

/// Source of a datagram.
struct PacketSource {
  std::array<std::uint8_t, 16> address{};  ///< IPv6, or IPv4 as ::ffff:a.b.c.d
  std::uint16_t port = 0;

  static PacketSource ipv4(std::array<std::uint8_t, 4> address, std::uint16_t port);
  std::string address_text() const;  ///< "10.0.0.7"
};

/// Tokens that refill with time.
class TokenBucket {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  struct Rate {
    double per_s;
    double burst;  ///< tokens of a full bucket
  };

  TokenBucket(Rate rate, TimePoint now) : rate_(rate), tokens_(rate.burst), filled_(now) {}

  bool has_token(TimePoint now) const { return tokens(now) >= 1; }
  bool is_full(TimePoint now) const { return tokens(now) >= rate_.burst; }
  void take(TimePoint now);

 private:
  double tokens(TimePoint now) const;

  Rate rate_;
  double tokens_;
  TimePoint filled_;
};

/// The verdict on a datagram.
enum class PacketVerdict {
  Heard,
  Broken,           ///< no datagram that a participant sends
  WithoutIdentity,  ///< a newcomer without a certificate's name, where that is needed
  Stranger,         ///< its sender was never announced
  OtherPlace,       ///< its sender was announced from another address
  PortRate,         ///< a newcomer beyond the rate of its address and port
  AddressRate,      ///< ... of its address
  OverallRate,      ///< ... of all addresses of other machines
  PeerRate,         ///< an announcement of a known participant beyond its rate
  AddressFull,      ///< a newcomer beyond the participants of one address, or of this machine
  Full              ///< a newcomer beyond the participants in all
};
inline constexpr std::size_t kPacketVerdicts = 11;

/// The remote participants that a server hears, by GUID prefix: each at the address of its first
/// announcement. Decides about every datagram, in bounded memory. Newcomers are admitted at rates
/// by address and port, by address and, from other machines, overall: a flood from one source
/// leaves those of others their share. This machine's addresses count as one. Not to be shared
/// between threads; time is passed in.
class PeerTable {
 public:
  using TimePoint = TokenBucket::TimePoint;

  /// Newcomers of one port, of one address, and how many of an address may be known.
  struct Bounds {
    TokenBucket::Rate port, address;
    std::size_t peers;
  };
  static constexpr Bounds kBoundsElsewhere{{16, 64}, {40, 128}, 1024};
  /// Of all addresses of this machine together: the clients of a server that has started anew come
  /// back at once, and its kernel bounds a flood. Who asks for the first time from its port has
  /// further places and a rate of their own, so that others cannot keep it out.
  static constexpr Bounds kBoundsHere{{16, 256}, {40, 512}, 1536};
  static constexpr std::size_t kMaxPeersHere = 2048;
  static constexpr std::size_t kMaxPeersElsewhere = 3072;  ///< on other machines
  static constexpr std::size_t kMaxPeers = kMaxPeersHere + kMaxPeersElsewhere;
  static constexpr TokenBucket::Rate kOverallRate{100, 512}, kFirstRate{40, 256}, kPeerRate{4, 8};
  /// A participant that announces a longer lease has this one.
  static constexpr std::chrono::seconds kMaxLease{15};

  /// A datagram, as read_datagram() gave it.
  /// \param is_local  whether the source's address is one of this machine. Linux drops packets that
  ///                  come from outside with such an address (sysctl accept_local and
  ///                  route_localnet are off unless somebody has set them).
  PacketVerdict take(const std::optional<Datagram>& datagram, const PacketSource& source,
                     bool is_local, bool needs_identity, TimePoint now);

  struct Peer {
    PacketSource source;  ///< of its first announcement
    bool is_local = false;
  };
  /// Nothing for a participant that is not known.
  std::optional<Peer> find(const GuidPrefix& prefix) const;

  std::size_t size() const { return peers_.size(); }
  std::size_t buckets() const { return by_port_.size() + by_address_.size(); }

 private:
  using Address = std::array<std::uint8_t, 16>;
  struct Entry {
    Peer peer;
    std::chrono::seconds lease;
    TimePoint expires;
    TokenBucket announcements;
  };
  struct OfAddress {
    TokenBucket newcomers;
    std::size_t peers = 0;
  };
  struct PrefixHash {
    std::size_t operator()(const GuidPrefix& prefix) const;
  };

  PacketVerdict take_known(Entry& entry, const Datagram& datagram, const PacketSource& source,
                           bool is_local, TimePoint now);
  PacketVerdict take_newcomer(const Datagram& datagram, const PacketSource& source, bool is_local,
                              TimePoint now);
  PacketVerdict judge_newcomer(const PacketSource& source, bool is_local, TimePoint now) const;
  static Address address_of(const Peer& peer);
  bool asks_first(const PacketSource& source, TimePoint now);
  void sweep(TimePoint now);

  std::unordered_map<GuidPrefix, Entry, PrefixHash> peers_;
  std::map<Address, OfAddress> by_address_;
  std::map<std::pair<Address, std::uint16_t>, TokenBucket> by_port_;
  std::optional<TokenBucket> overall_;
  std::size_t peers_here_ = 0;
  std::vector<bool> asked_;  // by hash of an address of this machine and a port, since cleared_
  std::optional<TokenBucket> firsts_;
  TimePoint swept_{}, cleared_{};
};

}  // namespace kinship::dds
