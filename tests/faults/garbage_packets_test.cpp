#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <iostream>
#include <random>
#include <thread>

#include "proto/dds/participant.hpp"
#include "tests/faults/bystander.hpp"
#include "tests/faults/captured_packets.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// Garbage at the server's UDP ports: it lives, serves, and neither its memory nor its log grows
/// with it. KINSHIP_LONG=1: for two minutes.
namespace kinship::test::garbage_packets_test {
namespace {

constexpr std::uint64_t kSeed = 20261123;

/// Sends garbage from its construction to its end.
class GarbageSender {
 public:
  GarbageSender(std::uint32_t domain, std::vector<Packet> packets)
      : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
        packets_(std::move(packets)),
        thread_([this, domain](const std::stop_token& stop) { send_until(stop, domain); }) {}
  GarbageSender(const GarbageSender&) = delete;
  GarbageSender& operator=(const GarbageSender&) = delete;
  ~GarbageSender() {
    thread_.request_stop();
    thread_.join();
    close(socket_);
  }

  std::uint64_t sent() const { return sent_; }

 private:
  void send_until(const std::stop_token& stop, std::uint32_t domain) {
    std::mt19937_64 generator(kSeed);
    const auto ports = dds::server_ports(domain);
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    while (!stop.stop_requested()) {
      const Packet packet = make_garbage(packets_, generator);
      server.sin_port = htons(ports[generator() % ports.size()]);
      if (sendto(socket_, packet.data(), packet.size(), 0,
                 reinterpret_cast<const sockaddr*>(&server), sizeof server) >= 0)
        ++sent_;
    }
  }

  int socket_;
  const std::vector<Packet> packets_;
  std::atomic<std::uint64_t> sent_ = 0;
  std::jthread thread_;  // last: uses the others
};

TEST(GarbagePackets, AtTheServersPortsHarmNobody) {
  const ReservedDomain domain;
  const TemporaryDirectory directory;
  ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  Bystander bystander(domain.number(), directory / "outbox");
  const std::vector<Packet> packets = capture_client(domain.number(), directory.path());
  const Bystander::Rounds alone = bystander.live(30);
  const double before_mb = figures_of(server.pid()).resident_mb;

  GarbageSender sender(domain.number(), packets);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(is_long_run() ? 120 : 4);
  Bystander::Rounds beside;
  double most_mb = 0;
  while (beside.unanswered() == 0 && std::chrono::steady_clock::now() < end) {
    beside = bystander.live(30);
    most_mb = std::max(most_mb, figures_of(server.pid()).resident_mb);
  }

  std::cout << table_row("beside garbage", alone, beside) << '\n'
            << sender.sent() << " packets of garbage made of " << packets.size()
            << " captured ones; the server had " << before_mb << " MB, then at most " << most_mb
            << " MB, and wrote " << std::filesystem::file_size(directory / "fleet.db.log")
            << " B\n";
  EXPECT_EQ(beside.unanswered(), 0U) << beside.answers();
  EXPECT_GT(sender.sent(), 1000U);
  EXPECT_LT(most_mb, before_mb + 200 + kQuarantine_mb);
  EXPECT_LT(std::filesystem::file_size(directory / "fleet.db.log"),
            is_long_run() ? 1'000'000U : 100'000U);
  EXPECT_EQ(server.terminate(), 0);
}

}  // namespace
}  // namespace kinship::test::garbage_packets_test
