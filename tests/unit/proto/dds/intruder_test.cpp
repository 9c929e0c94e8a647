// What somebody cannot do who has the certificate of a client and a Cyclone DDS that he changed.
// Each test first sees that the same works where it may, so that it would not go unnoticed.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/unit/proto/dds/secured_fleet.hpp"

namespace kinship::dds::intruder_test {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;

class Intruder : public test::SecuredFleet {
 protected:
  /// Bob, who has a certificate of this fleet.
  ChildProcess intrude(const std::string& verb, const std::string& partition,
                       const std::string& way, const std::string& text = "") const {
    return ChildProcess({KINSHIP_INTRUDER, verb, domain(), bob_, partition, way, text});
  }

  const std::filesystem::path bob_ =
      add(fleet_, {.name = "bob", .role = AccessRole::Reader}, "bob");
};

/// Whether `log` has it within some seconds.
template <typename Log>
bool comes(const std::string& text, const Log& log) {
  const auto deadline = std::chrono::steady_clock::now() + 8s;
  while (std::chrono::steady_clock::now() < deadline)
    if (log().find(text) != std::string::npos)
      return true;
  return false;
}

TEST_F(Intruder, WritesInHisOwnPartitionOnly) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  const auto log = [&] { return ask(requester, "log"); };
  ChildProcess changed = intrude("write", "client_alice", "changed", "changed");
  ASSERT_EQ(changed.read_line(), "joined");
  ChildProcess hidden = intrude("write", "client_alice", "hidden", "hidden");
  ASSERT_EQ(hidden.read_line(), "joined");
  ChildProcess all = intrude("write", "client_*", "hidden", "all");
  ASSERT_EQ(all.read_line(), "joined");
  ChildProcess nowhere = intrude("write", "-", "changed", "nowhere");
  ASSERT_EQ(nowhere.read_line(), "joined");
  ChildProcess own = intrude("write", "client_bob", "changed", "own");
  ASSERT_EQ(own.read_line(), "joined");
  EXPECT_TRUE(comes("bob:own", log));  // who began last is heard: the others would have been
  const std::string done = log();
  for (const char* const never : {"changed", "hidden", "all", "nowhere"})
    EXPECT_EQ(done.find(never), std::string::npos) << done;
}

TEST_F(Intruder, IsHeldBackByHisOwnSideIfItIsHonest) {
  ChildProcess honest = intrude("write", "client_alice", "honest", "x");
  const std::string line = honest.read_line();
  EXPECT_NE(line.find("refused"), std::string::npos) << line;
}

TEST_F(Intruder, ReadsNobodyElsesReplies) {
  ASSERT_EQ(server_.read_line(), "ready");
  ChildProcess changed = intrude("read", "client_alice", "changed");
  ASSERT_EQ(changed.read_line(), "joined");
  ChildProcess hidden = intrude("read", "client_alice", "hidden");
  ASSERT_EQ(hidden.read_line(), "joined");
  ChildProcess own = intrude("read", "client_bob", "changed");
  ASSERT_EQ(own.read_line(), "joined");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "for alice"), "for alice");
  // Bob's own reader hears what bob is told, from when it has matched on.
  ChildProcess bobs = intrude("write", "client_bob", "honest", "for bob");
  const auto deadline = std::chrono::steady_clock::now() + 8s;
  while (!own.has_output() && std::chrono::steady_clock::now() < deadline)
    EXPECT_EQ(ask(requester, "for alice"), "for alice");
  ASSERT_TRUE(own.has_output());
  EXPECT_EQ(own.read_line(), "heard for bob");
  EXPECT_FALSE(changed.has_output());
  EXPECT_FALSE(hidden.has_output());
}

TEST_F(Intruder, IsAServerWithoutSecurity) {
  const test::ReservedDomain open;
  ChildProcess rogue(
      {KINSHIP_INTRUDER, "serve", std::to_string(open.number()), "-", "-", "honest"});
  ASSERT_EQ(rogue.read_line(), "joined");
  const Participant participant({.domain = open.number()});
  AdminRequester requester(participant, Uuid::random());
  ask(requester, "secret", 1500ms);
  ASSERT_TRUE(rogue.has_output());
  EXPECT_EQ(rogue.read_line(), "heard secret");
}

TEST_F(Intruder, IsNoServer) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "hello"), "hello");
  server_.kill();
  for (const char* const way : {"changed", "hidden"}) {
    ChildProcess rogue = intrude("serve", "client_alice", way);
    ASSERT_EQ(rogue.read_line(), "joined");
    const std::string answer = ask(requester, "secret", 1500ms);
    EXPECT_NE(answer.find(" ms (domain "), std::string::npos) << answer;  // nobody answered
    EXPECT_FALSE(rogue.has_output()) << way;
  }
}

}  // namespace
}  // namespace kinship::dds::intruder_test
