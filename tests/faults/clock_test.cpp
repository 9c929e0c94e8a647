#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>

#include "proto/security/security_folder.hpp"
#include "tests/faults/chaos_fleet.hpp"

/// The wall clock of a fleet is set while it works: nobody waits for the time in between.
namespace kinship::test::clock_test {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
namespace fs = std::filesystem;

constexpr std::size_t kClients = 3;
constexpr seconds kAtOnce{30};  // instead of hours; the machine may have other work

/// By which the clock is ahead after each time. With security: Cyclone DDS waits for more there.
class ClockIsSet : public testing::TestWithParam<hours> {
 protected:
  void SetUp() override {
    const fs::path fleet = folder_ / "fleet";
    const std::vector<std::string> arguments = {"--domain",   std::to_string(domain_.number()),
                                                "--store",    (folder_ / "fleet.db").string(),
                                                "--security", fleet.string()};
    std::vector<ChaosClients::Place> places(kClients, {domain_.number()});
    // Valid whatever the clock is set to.
    const auto made = std::chrono::floor<seconds>(std::chrono::system_clock::now()) - hours(48);
    const auto security = security::SecurityFolder::init(fleet, security::kDefaultDays, made);
    for (std::size_t client = 0; client < kClients; ++client) {
      const std::string name = "r" + std::to_string(client);
      places[client].credentials = folder_ / name.c_str();
      security.add({.name = name}, places[client].credentials, made);
    }
    clients_.emplace(folder_.path(), clock_, places, kClients);
    server_.emplace(clock_, "kinshipd", folder_ / "server.log", [arguments] { return arguments; });
    server_->start();
    clients_->start_all();
  }
  /// Until each outbox has so many receipts more. The last two clients share one.
  void wait_for_receipts(std::ptrdiff_t count) const {
    for (std::size_t outbox = 0; outbox < kClients - 1; ++outbox) {
      const fs::path sent = folder_ / ("outbox-" + std::to_string(outbox)).c_str() / "sent";
      const auto receipts = [&sent] {
        return fs::exists(sent) ? std::distance(fs::directory_iterator(sent), {}) : 0;
      };
      const auto end = std::chrono::steady_clock::now() + kAtOnce;
      for (const auto wanted = receipts() + count; receipts() < wanted;) {
        ASSERT_LT(std::chrono::steady_clock::now(), end) << read_text(folder_ / "server.log");
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    }
  }

  const TemporaryDirectory folder_;
  const JumpingClock clock_{folder_ / "clock"};
  const ReservedDomain domain_;
  std::optional<ChaosClients> clients_;
  std::optional<Supervised> server_;
};

/// Each time a client is at another point of its discovery and handshake.
TEST_P(ClockIsSet, WhileAClientJoins) {
  constexpr int kTimes = 12;
  constexpr std::chrono::milliseconds kLater{30};
  wait_for_receipts(1);
  Dice dice(1);
  for (int time = 1; time <= kTimes; ++time) {
    clients_->any(dice).kill_and_start();
    std::this_thread::sleep_for(time * kLater);
    clock_.jump_to(GetParam() * time);
    wait_for_receipts(1);
    if (HasFatalFailure())
      return;
  }
  clients_->drain();
  EXPECT_EQ(server_->terminate(), 0);
}

INSTANTIATE_TEST_SUITE_P(, ClockIsSet, testing::Values(-hours(1), hours(1)), [](const auto& ahead) {
  return std::string(ahead.param < hours(0) ? "Back" : "Ahead");
});

}  // namespace
}  // namespace kinship::test::clock_test
