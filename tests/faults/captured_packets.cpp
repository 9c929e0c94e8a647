#include "tests/faults/captured_packets.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "client/link/client.hpp"
#include "proto/dds/participant.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"

namespace kinship::test {
namespace {

using std::chrono::seconds;

/// The packets of a capture file in the pcap format that were sent.
std::vector<Packet> read_sent(const std::string& pcap) {
  constexpr std::size_t kFileHeader = 24, kRecordHeader = 16, kIpAndUdpHeaders = 28, kTtl = 8;
  constexpr unsigned char kTtlOfSent = 255;  // says Cyclone DDS's manual
  std::vector<Packet> packets;
  std::size_t at = kFileHeader;
  while (at + kRecordHeader + kIpAndUdpHeaders < pcap.size()) {
    std::uint32_t size = 0;
    std::memcpy(&size, pcap.data() + at + 8, sizeof size);
    at += kRecordHeader;
    if (size <= kIpAndUdpHeaders || at + size > pcap.size())
      break;
    if (static_cast<unsigned char>(pcap[at + kTtl]) == kTtlOfSent)
      packets.emplace_back(pcap.data() + at + kIpAndUdpHeaders, pcap.data() + at + size);
    at += size;
  }
  return packets;
}

std::uint8_t any_byte(std::mt19937_64& generator) { return static_cast<std::uint8_t>(generator()); }

Packet random_bytes(std::size_t size, std::mt19937_64& generator) {
  Packet bytes(size);
  std::generate(bytes.begin(), bytes.end(), [&] { return any_byte(generator); });
  return bytes;
}

/// A header of RTPS 2.1 and up to six submessages of which only the frame is right, mostly.
Packet made_up(std::mt19937_64& generator) {
  constexpr std::array<std::uint8_t, 15> kIds = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e,
                                                 0x0f, 0x12, 0x13, 0x15, 0x16, 0x30, 0x31};
  Packet packet = random_bytes(20, generator);
  std::memcpy(packet.data(), "RTPS\2\1\1\20", 8);  // Cyclone DDS is vendor 1.16
  for (std::uint64_t left = generator() % 7; left > 0; --left) {
    const Packet body = random_bytes(4 * (generator() % 40), generator);
    const auto length =
        static_cast<std::uint16_t>(generator() % 8 == 0 ? generator() : body.size());
    packet.push_back(kIds[generator() % kIds.size()]);
    packet.push_back(any_byte(generator) | 1U);  // little endian
    packet.push_back(static_cast<std::uint8_t>(length & 0xffU));
    packet.push_back(static_cast<std::uint8_t>(length >> 8U));
    packet.insert(packet.end(), body.begin(), body.end());
  }
  return packet;
}

void change(Packet& packet, const Packet& other, std::mt19937_64& generator) {
  constexpr std::array<std::uint32_t, 8> kNumbers = {
      0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe, 0x10000, 0x7fff0000};
  const std::size_t at = generator() % packet.size();
  switch (generator() % 6) {
    case 0:
      packet[at] ^= static_cast<std::uint8_t>(1U << generator() % 8);
      break;
    case 1:
      packet[at] = any_byte(generator);
      break;
    case 2: {
      const std::uint32_t number = kNumbers[generator() % kNumbers.size()];
      std::memcpy(packet.data() + at, &number, std::min(sizeof number, packet.size() - at));
      break;
    }
    case 3:
      packet.resize(at + 1);
      break;
    case 4:
      packet.resize(at + 1);
      packet.insert(
          packet.end(),
          other.begin() + static_cast<Packet::difference_type>(std::min(at, other.size())),
          other.end());
      break;
    default: {
      const Packet grown = random_bytes(1 + generator() % 32, generator);
      packet.insert(packet.begin() + static_cast<Packet::difference_type>(at), grown.begin(),
                    grown.end());
    }
  }
}

}  // namespace

std::vector<Packet> capture_client(std::uint32_t domain, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "capture.pcap";
  std::string configuration = dds::cyclone_configuration({.domain = domain});
  configuration.insert(
      configuration.find("</Domain>"),
      "<Tracing><PacketCaptureFile>" + file.string() + "</PacketCaptureFile></Tracing>");
  setenv("CYCLONEDDS_URI", configuration.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  Program client("../tests/faults_fleet",
                 {"captured", std::to_string(domain), (folder / "captured-outbox").string()},
                 folder / "clients.log");
  unsetenv("CYCLONEDDS_URI");  // NOLINT(concurrency-mt-unsafe)
  if (client.wait() != 0)
    throw std::runtime_error("captured client: " + read_text(folder / "clients.log"));
  std::vector<Packet> packets = read_sent(read_text(file));
  if (packets.size() < 20)
    throw std::runtime_error("only " + std::to_string(packets.size()) + " packets were captured");
  return packets;
}

int run_captured_client(const std::vector<std::string>& arguments) {
  link::Client client({.domain = static_cast<std::uint32_t>(std::stoul(arguments.at(0))),
                       .outbox = arguments.at(1),
                       .timeout = seconds(20)});
  const Digest panda = client.register_robot(model_description("panda")).value_or_throw().robot;
  const auto watcher = client.watch({.on_event = [](const Event&) {}});
  for (std::uint64_t i = 0; i < 6; ++i)
    client.report(panda_attempt(panda, "captured", i));
  client.flush(seconds(20));
  FetchRequest request;
  request.task = "captured";
  request.robot = panda;
  request.deadline = seconds(20);
  const auto follower = client.follow(request);
  static_cast<void>(client.fetch(request).value_or_throw());
  AdminRequest list;
  list.verb = AdminVerb::ListPaths;
  static_cast<void>(client.admin(list).value_or_throw());
  return 0;
}

Packet make_garbage(const std::vector<Packet>& packets, std::mt19937_64& generator) {
  const std::uint64_t kind = generator() % 10;
  if (kind == 0)
    return random_bytes(generator() % 2000, generator);
  if (kind == 1)
    return made_up(generator);
  constexpr std::size_t kMagic = 4, kPrefix = 8, kHeader = 20;  // of who sends: GUID prefix
  Packet packet = packets[generator() % packets.size()];
  if (packet.size() > kHeader && generator() % 2 == 0)
    std::generate_n(packet.begin() + kPrefix, kHeader - kPrefix,
                    [&] { return any_byte(generator); });
  if (kind == 2)
    return packet;
  for (std::uint64_t left = 1 + generator() % 8; left > 0; --left)
    change(packet, packets[generator() % packets.size()], generator);
  if (packet.size() > kMagic)
    std::memcpy(packet.data(), "RTPS", kMagic);  // the rest of it would not be looked at
  return packet;
}

}  // namespace kinship::test
