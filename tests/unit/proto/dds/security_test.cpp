// Who may talk to whom in a domain with security: client and server in processes of their own.

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "proto/dds/endpoint_guard.hpp"
#include "proto/dds/packet_guard.hpp"
#include "tests/unit/proto/dds/secured_fleet.hpp"

namespace kinship::dds::security_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class Security : public test::SecuredFleet {};

TEST_F(Security, TheServerKnowsAClientByItsCertificate) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester one(participant, Uuid::random());
  EXPECT_EQ(ask(one, "who"), "alice|alice|operator|shelf_*|local");

  // A program that runs twice.
  const Participant again = join(alice_);
  AdminRequester other(again, Uuid::random());
  EXPECT_EQ(ask(other, "second"), "second");
  EXPECT_EQ(ask(one, "first"), "first");
}

TEST_F(Security, AFloodOfWhoIsRevokedIsNotAllAnswered) {
  constexpr int kAtOnce = 40;  // ten a second are answered
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "before"), "before");
  fleet_.revoke("alice", now());
  const auto deadline = AdminRequester::Clock::now() + 10s;
  while (ask(requester, "again").find("revoked") == std::string::npos &&
         AdminRequester::Clock::now() < deadline) {
  }
  std::atomic<int> answered = 0;
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < kAtOnce; ++i)
      callers.emplace_back([&] {
        if (ask(requester, "flood", 1200ms).find("revoked") != std::string::npos)
          ++answered;
      });
  }
  EXPECT_GT(answered, 0);
  EXPECT_LT(answered, kAtOnce);
}

TEST_F(Security, NobodyElseIsHeard) {
  // Without security who has no certificate is, and with another authority's he is its own
  // server's.
  const test::ReservedDomain open, of_another;
  const fs::path namesake =
      add(init("another"), {.name = "alice", .role = AccessRole::Admin}, "namesake");
  test::ChildProcess open_server({KINSHIP_ECHO_SERVER, std::to_string(open.number())});
  test::ChildProcess another_server(
      {KINSHIP_ECHO_SERVER, std::to_string(of_another.number()), directory_ / "another"});
  ASSERT_EQ(open_server.read_line(), "ready");
  ASSERT_EQ(another_server.read_line(), "ready");
  const auto ask_in = [](const test::ReservedDomain& domain, const fs::path& credentials) {
    const Participant participant({.domain = domain.number(), .security = credentials});
    AdminRequester requester(participant, Uuid::random());
    return ask(requester, "hello");
  };
  ASSERT_EQ(ask_in(open, {}), "hello");
  ASSERT_EQ(ask_in(of_another, namesake), "hello");

  ASSERT_EQ(server_.read_line(), "ready");
  ASSERT_EQ(ask_as(alice_, "hello"), "hello");  // the server is heard by whom it may hear
  EXPECT_NE(ask_as(namesake, "other authority", 1500ms).find("no server answered"),
            std::string::npos);
  EXPECT_NE(ask_as({}, "no certificate", 1000ms).find("no server answered"), std::string::npos);
}

TEST_F(Security, CredentialsThatCannotBeAreRefusedInWords) {
  const auto message = [&](const ParticipantOptions& options) -> std::string {
    try {
      const Participant participant(options);
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "joined";
  };
  const std::string other_side =
      message({.domain = domain_.number(), .security = fleet_.server_credentials()});
  EXPECT_NE(other_side.find("has the credentials of the server"), std::string::npos) << other_side;
  fs::remove(alice_ / "key.pem");
  const std::string incomplete = message({.domain = domain_.number(), .security = alice_});
  EXPECT_NE(incomplete.find("key.pem"), std::string::npos) << incomplete;
}

TEST_F(Security, AProcessHasOneNameInADomain) {
  const Participant participant = join(alice_);
  const fs::path bob = add(fleet_, {.name = "bob"}, "bob");
  EXPECT_THROW(join(bob), Failure);  // Cyclone DDS would take alice's permissions for bob's
  EXPECT_NO_THROW(join(alice_));
}

TEST_F(Security, ClientsOfOneProcessMayJoinAtTheSameTime) {
  constexpr int kClients = 4;
  for (int round = 0; round < 5; ++round) {  // the plugins are loaded anew in each
    std::atomic<int> joined = 0;
    std::barrier begin(kClients), end(kClients);
    std::vector<std::jthread> threads;
    for (int i = 0; i < kClients; ++i)
      threads.emplace_back([&] {
        std::optional<Participant> participant;
        begin.arrive_and_wait();
        try {
          participant.emplace(join(alice_));
          ++joined;
        } catch (const Failure& failure) {
          ADD_FAILURE() << failure.what();
        }
        end.arrive_and_wait();
      });
    threads.clear();
    EXPECT_EQ(joined, kClients);
  }
}

TEST(Loopback, AServerWithoutInterfaceIsNotHeardFromTheNetwork) {
  const test::ReservedDomain domain;
  test::ChildProcess server({KINSHIP_ECHO_SERVER, std::to_string(domain.number())});
  ASSERT_EQ(server.read_line(), "ready");
  std::ifstream sockets("/proc/net/udp");
  int found = 0;
  for (std::string line; std::getline(sockets, line);) {
    std::istringstream words(line);
    std::string number, address;
    words >> number >> address;
    for (const std::uint16_t port : server_ports(domain.number())) {
      std::ostringstream end;
      end << ':' << std::uppercase << std::hex << std::setfill('0') << std::setw(4) << port;
      if (!address.ends_with(end.str()))
        continue;
      ++found;
      EXPECT_EQ(address, "0100007F" + end.str());  // 127.0.0.1, as this machine has it
    }
  }
  EXPECT_EQ(found, 2);
}

TEST(PacketGuard, IsInFrontOfCycloneDds) { EXPECT_NO_THROW(PacketGuard(true)); }

TEST(SecurityGuard, IsInFrontOfCycloneDds) { EXPECT_TRUE(is_endpoint_guard_in_place()); }

TEST_F(Security, WithoutItCallersAreTheirParticipants) {
  const test::ReservedDomain domain;
  test::ChildProcess server({KINSHIP_ECHO_SERVER, std::to_string(domain.number())});
  ASSERT_EQ(server.read_line(), "ready");
  const Participant participant({.domain = domain.number()});
  AdminRequester one(participant, Uuid::random());
  AdminRequester other(participant, Uuid::random());  // an id that was made up
  const std::string answer = ask(one, "who");
  EXPECT_EQ(ask(other, "who"), answer);
  EXPECT_NE(answer.find("||admin||local"), std::string::npos) << answer;
  const Participant second({.domain = domain.number()});
  AdminRequester third(second, Uuid::random());
  EXPECT_NE(ask(third, "who"), answer);
}

}  // namespace
}  // namespace kinship::dds::security_test
