#include "tests/faults/announcement_flood.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <stdexcept>
#include <utility>

#include "proto/dds/datagram.hpp"
#include "proto/dds/participant.hpp"

namespace kinship::test {
namespace {

sockaddr_in address_of(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1)
    throw std::runtime_error("no address: " + host);
  return address;
}

int socket_at(const std::string& host) {
  const int made = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = address_of(host, 0);
  if (made < 0 || bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("no socket at " + host);
  return made;
}

/// Replaces every occurrence.
template <typename From, typename To>
bool replace_all(Packet& packet, const From& from, const To& to) {
  bool is_found = false;
  for (auto at = packet.begin();; at += static_cast<std::ptrdiff_t>(to.size())) {
    at = std::search(at, packet.end(), from.begin(), from.end());
    if (at == packet.end())
      return is_found;
    std::ranges::copy(to, at);
    is_found = true;
  }
}

}  // namespace

Packet endless_announcement(const std::vector<Packet>& packets) {
  constexpr std::array<std::uint8_t, 12> kLease = {2, 0, 8, 0, 5, 0, 0, 0, 0, 0, 0, 0},
                                         kEndless = {2, 0, 8, 0, 0xff, 0xff, 0xff, 0x7f};
  for (Packet packet : packets) {
    const auto datagram = dds::read_datagram(packet);
    if (datagram && datagram->announcement && !datagram->announcement->is_departure &&
        replace_all(packet, kLease, kEndless))
      return packet;
  }
  throw std::runtime_error("no announcement was captured");
}

AnnouncementFlood::AnnouncementFlood(Options options) : options_(std::move(options)) {
  for (int i = 0; i < options_.ports; ++i)
    sockets_.push_back(socket_at(options_.from));
  thread_ = std::jthread([this](const std::stop_token& stop) { send_until(stop); });
}

AnnouncementFlood::~AnnouncementFlood() {
  thread_.request_stop();
  thread_.join();
  for (const int each : sockets_)
    close(each);
}

void AnnouncementFlood::send_until(const std::stop_token& stop) {
  constexpr std::uint64_t kSeed = 20261128;
  std::mt19937_64 generator(kSeed);
  const sockaddr_in server = address_of("127.0.0.1", dds::discovery_port(options_.domain));
  dds::GuidPrefix last = dds::read_datagram(options_.announcement).value().sender;
  Packet packet = options_.announcement;
  const auto begin = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    dds::GuidPrefix next = last;
    std::generate(next.begin() + 2, next.end(),
                  [&] { return static_cast<std::uint8_t>(generator()); });
    replace_all(packet, last, next);
    last = next;
    if (sendto(sockets_[sent_ % sockets_.size()], packet.data(), packet.size(), 0,
               reinterpret_cast<const sockaddr*>(&server), sizeof server) >= 0)
      ++sent_;
    std::this_thread::sleep_until(
        begin + std::chrono::duration<double>(static_cast<double>(sent_) / options_.per_s));
  }
}

}  // namespace kinship::test
