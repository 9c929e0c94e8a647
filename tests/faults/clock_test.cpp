#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>

#include "proto/security/authority_folder.hpp"
#include "proto/security/permissions.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/faults/chaos_fleet.hpp"

/// The wall clock of a fleet is set while it works: nobody waits for the time in between.
namespace kinship::test::clock_test {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
namespace fs = std::filesystem;

constexpr std::size_t kClients = 3;
constexpr seconds kAtOnce{60};  // instead of hours; the machine may have other work

std::chrono::sys_seconds wall_now() {
  return std::chrono::floor<seconds>(std::chrono::system_clock::now());
}

/// Waits for something, with a moment's pauses.
template <typename Happened>
void wait_until(const Happened& has_happened, const fs::path& log) {
  const auto end = std::chrono::steady_clock::now() + kAtOnce;
  while (!has_happened()) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << read_text(log);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::ptrdiff_t receipts_of(const fs::path& outbox) {
  return fs::exists(outbox / "sent") ? std::distance(fs::directory_iterator(outbox / "sent"), {})
                                     : 0;
}

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

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
    const auto made = wall_now() - hours(48);
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
    for (std::size_t client = 0; client < kClients - 1; ++client) {
      const fs::path outbox = folder_ / ("outbox-" + std::to_string(client)).c_str();
      const auto wanted = receipts_of(outbox) + count;
      wait_until([&] { return receipts_of(outbox) >= wanted; }, folder_ / "server.log");
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

enum class Side { Clients, Server };

/// The clock of one side. A day ago certificates are valid by it, and the permissions of the other
/// side are not: those Cyclone DDS judges once, and certificates each second.
class ClockIsWrong : public testing::TestWithParam<Side> {
 protected:
  ClockIsWrong() {
    const auto security = security::SecurityFolder::init(fleet_, security::kDefaultDays, made_);
    security.add({.name = "r0"}, client_, made_);
    const security::Validity later{wall_now() - hours(1), made_ + security::kDefaultDays};
    sign(is_clients_ ? security::server_permissions(security::kServerName, later)
                     : security::client_permissions("r0", AccessRole::Robot, later),
         is_clients_ ? security.server_credentials() : client_);
  }
  void sign(const std::string& permissions, const fs::path& credentials) const {
    const fs::path file = security::CredentialFiles(credentials).permissions;
    fs::remove(file);
    std::ofstream(file) << security::sign_document(
        permissions, security::AuthorityFolder(fleet_ / "authority").for_clients().signer,
        {made_, made_ + security::kDefaultDays});
  }

  /// \param refusal  what the side with the wrong clock says of each client.
  void expect_receipts_once_it_is_right(std::string_view refusal) {
    wait_until([&] { return count(read_text(wrong_log_), refusal) >= 2; }, wrong_log_);
    wrong_.jump_to(seconds(0));
    wait_until([this] { return receipts_of(folder_ / "outbox-0") > 0; }, wrong_log_);
    clients_.drain();
    EXPECT_EQ(server_.terminate(), 0);
  }

  const TemporaryDirectory folder_;
  const fs::path fleet_ = folder_ / "fleet", client_ = folder_ / "r0";
  const std::chrono::sys_seconds made_ = wall_now() - hours(48);
  const ReservedDomain domain_;
  const JumpingClock clock_of_clients_{folder_ / "clock"};
  const JumpingClock clock_of_server_{folder_ / "server_clock"};
  const bool is_clients_ = GetParam() == Side::Clients;
  const JumpingClock& wrong_ = is_clients_ ? clock_of_clients_ : clock_of_server_;
  const fs::path wrong_log_ = folder_ / (is_clients_ ? "clients.log" : "server.log");
  ChaosClients clients_{folder_.path(), clock_of_clients_, {{domain_.number(), client_}}, 2};
  Supervised server_{clock_of_server_, "kinshipd", folder_ / "server.log", [this] {
                       return std::vector<std::string>{
                           "--domain",   std::to_string(domain_.number()),
                           "--store",    (folder_ / "fleet.db").string(),
                           "--security", fleet_.string()};
                     }};
};

/// Two clients with one outbox, both refused; one of them waits until the other has sent.
TEST_P(ClockIsWrong, ByADayWhileClientsJoin) {
  server_.start();
  server_.program().read_line();
  wrong_.jump_to(-hours(24));
  clients_.start_all();
  expect_receipts_once_it_is_right("validity period has not started");
}

/// No participant can be made then: the clock is set when they have been, and meet.
TEST_P(ClockIsWrong, ByYearsWhileClientsMeetTheServer) {
  constexpr hours kThreeYears{3 * 8760};
  if (is_clients_) {
    clients_.start_all();
    wait_until(
        [this] { return fs::exists(folder_ / "ledger-1") && fs::exists(folder_ / "ledger-2"); },
        wrong_log_);
    wrong_.jump_to(-kThreeYears);
    server_.start();
  } else {
    server_.start();
    server_.program().read_line();
    wrong_.jump_to(-kThreeYears);
    clients_.start_all();
  }
  expect_receipts_once_it_is_right("certificate is not yet valid");
}

INSTANTIATE_TEST_SUITE_P(, ClockIsWrong, testing::Values(Side::Clients, Side::Server),
                         [](const auto& side) {
                           return std::string(side.param == Side::Clients ? "Clients" : "Server");
                         });

}  // namespace
}  // namespace kinship::test::clock_test
