#include "tests/support/loopback_capture.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <utility>

namespace kinship::test {
namespace {

std::uint16_t big_endian(const char* bytes) {
  std::uint16_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return ntohs(value);
}

/// What is in an IP packet of UDP.
std::optional<CapturedMessage> message_of(const char* packet, std::size_t size) {
  constexpr std::size_t kUdpHeader = 8, kProtocolAt = 9;
  const std::size_t header = size > 0 ? 4U * (static_cast<unsigned char>(packet[0]) & 0xfU) : 0;
  if (size < header + kUdpHeader || packet[kProtocolAt] != IPPROTO_UDP)
    return std::nullopt;
  return CapturedMessage{big_endian(packet + header + 2),
                         std::string(packet + header + kUdpHeader, packet + size)};
}

}  // namespace

std::optional<LoopbackCapture> LoopbackCapture::start() {
  const int descriptor = socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP));
  if (descriptor < 0)
    return std::nullopt;
  constexpr int kRoom = 16 << 20;
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &kRoom, sizeof kRoom);
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_IP);
  address.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) !=
      0) {  // NOLINT
    close(descriptor);
    return std::nullopt;
  }
  return LoopbackCapture(descriptor);
}

LoopbackCapture::LoopbackCapture(LoopbackCapture&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)) {}

LoopbackCapture::~LoopbackCapture() {
  if (socket_ >= 0)
    close(socket_);
}

std::vector<CapturedMessage> LoopbackCapture::take() const {
  std::vector<CapturedMessage> messages;
  std::vector<char> packet(1U << 17U);
  while (true) {
    sockaddr_ll from{};
    socklen_t length = sizeof from;
    const ssize_t size = recvfrom(socket_, packet.data(), packet.size(), MSG_DONTWAIT,
                                  reinterpret_cast<sockaddr*>(&from), &length);  // NOLINT
    if (size < 0)
      return messages;
    if (from.sll_pkttype == PACKET_OUTGOING)
      continue;  // comes a second time as what was received
    if (auto message = message_of(packet.data(), static_cast<std::size_t>(size)))
      messages.push_back(*std::move(message));
  }
}

std::optional<CapturedMessage> renumbered(CapturedMessage message, std::uint32_t more) {
  constexpr std::size_t kHeader = 20, kLowNumberAt = 20;
  constexpr char kData = 0x15;
  std::string& bytes = message.bytes;
  for (std::size_t at = kHeader; at + kLowNumberAt + sizeof more <= bytes.size();) {
    std::uint16_t length = 0;
    std::memcpy(&length, bytes.data() + at + 2, sizeof length);  // little endian, as this machine
    if (bytes[at] == kData) {
      std::uint32_t number = 0;
      std::memcpy(&number, bytes.data() + at + kLowNumberAt, sizeof number);
      number += more;
      std::memcpy(bytes.data() + at + kLowNumberAt, &number, sizeof number);
      return message;
    }
    at += 4U + length;
  }
  return std::nullopt;
}

void send_again(const CapturedMessage& message) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(message.port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sendto(descriptor, message.bytes.data(), message.bytes.size(), 0,
         reinterpret_cast<const sockaddr*>(&address), sizeof address);  // NOLINT
  close(descriptor);
}

}  // namespace kinship::test
