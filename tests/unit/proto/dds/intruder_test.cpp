// What somebody cannot do who has the certificate of a client and a Cyclone DDS that he changed.
// Each test also sees him do it: where there is no security, and, where it is the guard of
// Participant that stops him, with the same certificates against who has none (the intruder program
// itself).

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/proto/dds/secured_fleet.hpp"

namespace kinship::dds::intruder_test {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;

constexpr auto kPatience = 20s;

/// Whether `log` has it within some seconds.
template <typename Log>
bool comes(const std::string& text, const Log& log) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < deadline)
    if (log().find(text) != std::string::npos)
      return true;
  return false;
}

/// Whether the process says that this line reached it.
bool hears(ChildProcess& process, const std::string& text) {
  return process.has_output_within(kPatience) && process.read_line() == "heard " + text;
}

class Intruder : public test::SecuredFleet {
 protected:
  /// Who he claims to be, and how.
  struct Disguise {
    std::uint32_t domain = 0;
    std::filesystem::path credentials;
  };
  /// Returns once it has joined.
  static std::unique_ptr<ChildProcess> start(const Disguise& as, const std::string& verb,
                                             const std::string& partition, const std::string& way,
                                             const std::string& text = "") {
    auto process = std::make_unique<ChildProcess>(
        std::vector<std::string>{KINSHIP_INTRUDER, verb, std::to_string(as.domain),
                                 as.credentials.string(), partition, way, text});
    EXPECT_EQ(process->read_line(), "joined");
    return process;
  }
  Disguise bob() const { return {domain_.number(), bob_}; }
  /// In domains of their own, without security or with a server that has no guard.
  Disguise nobody() const { return {open_.number(), "-"}; }
  Disguise unguarded(const std::filesystem::path& credentials) const {
    return {unguarded_.number(), credentials};
  }

  /// What the tests show that he cannot, where he can.
  void write_as_anybody_without_security() const {
    ChildProcess server({KINSHIP_ECHO_SERVER, std::to_string(open_.number())});
    ASSERT_EQ(server.read_line(), "ready");
    const Participant participant({.domain = open_.number()});
    AdminRequester requester(participant, Uuid::random());
    const auto intruder = start(nobody(), "write", "-", "honest", "forged");
    EXPECT_TRUE(comes("forged", [&] { return ask(requester, "log"); }));
  }

  void read_all_replies_without_security() const {
    ChildProcess server({KINSHIP_ECHO_SERVER, std::to_string(open_.number())});
    ASSERT_EQ(server.read_line(), "ready");
    const auto intruder = start(nobody(), "read", "*", "honest");
    const Participant participant({.domain = open_.number()});
    AdminRequester requester(participant, Uuid::random());
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!intruder->has_output() && std::chrono::steady_clock::now() < deadline)
      ASSERT_EQ(ask(requester, "for alice"), "for alice");
    EXPECT_TRUE(hears(*intruder, "for alice"));
  }

  void be_a_server_without_security() const {
    const auto rogue = start(nobody(), "serve", "-", "honest");
    const Participant participant({.domain = open_.number()});
    AdminRequester requester(participant, Uuid::random());
    ask(requester, "secret", 1500ms);
    EXPECT_TRUE(hears(*rogue, "secret"));
  }

  const std::filesystem::path bob_ =
      add(fleet_, {.name = "bob", .role = AccessRole::Reader}, "bob");
  const test::ReservedDomain open_, unguarded_;
};

TEST_F(Intruder, WritesInHisOwnPartitionOnly) {
  write_as_anybody_without_security();
  {
    const auto server =
        start(unguarded(fleet_.server_credentials()), "serve", "client_*", "honest");
    const auto changed = start(unguarded(bob_), "write", "client_alice", "changed", "changed");
    const auto hidden = start(unguarded(bob_), "write", "client_alice", "hidden", "hidden");
    EXPECT_TRUE(hears(*server, "hidden")) << "is what the guard stops";
  }
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  const auto log = [&] { return ask(requester, "log"); };
  const auto changed = start(bob(), "write", "client_alice", "changed", "changed");
  const auto hidden = start(bob(), "write", "client_alice", "hidden", "hidden");
  const auto all = start(bob(), "write", "client_*", "hidden", "all");
  const auto nowhere = start(bob(), "write", "-", "changed", "nowhere");
  const auto own = start(bob(), "write", "client_bob", "changed", "own");
  EXPECT_TRUE(comes("bob:own", log));  // who began last is heard: the others would have been
  const std::string done = log();
  for (const char* const never : {"changed", "hidden", "all", "nowhere"})
    EXPECT_EQ(done.find(never), std::string::npos) << done;
}

TEST_F(Intruder, IsHeldBackByHisOwnSideIfItIsHonest) {
  ChildProcess honest({KINSHIP_INTRUDER, "write", domain(), bob_, "client_alice", "honest", "x"});
  const std::string line = honest.read_line();
  EXPECT_NE(line.find("refused"), std::string::npos) << line;
  start(nobody(), "write", "client_alice", "honest", "x");  // joins
}

TEST_F(Intruder, ReadsNobodyElsesReplies) {
  read_all_replies_without_security();
  {
    const auto server = start(unguarded(fleet_.server_credentials()), "tell", "client_alice",
                              "honest", "for alice");
    const auto hidden = start(unguarded(bob_), "read", "client_alice", "hidden");
    EXPECT_TRUE(hears(*hidden, "for alice")) << "is what the guard stops";
  }
  ASSERT_EQ(server_.read_line(), "ready");
  const auto changed = start(bob(), "read", "client_alice", "changed");
  const auto hidden = start(bob(), "read", "client_alice", "hidden");
  const auto own = start(bob(), "read", "client_bob", "changed");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "for alice"), "for alice");
  // Bob's own reader hears what bob is told, from when it has matched on.
  const auto bobs = start(bob(), "write", "client_bob", "honest", "for bob");
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!own->has_output() && std::chrono::steady_clock::now() < deadline)
    EXPECT_EQ(ask(requester, "for alice"), "for alice");
  EXPECT_TRUE(hears(*own, "for bob"));
  EXPECT_FALSE(changed->has_output());
  EXPECT_FALSE(hidden->has_output());
}

TEST_F(Intruder, IsNoServer) {
  be_a_server_without_security();
  {
    const auto rogue = start(unguarded(bob_), "serve", "client_alice", "hidden");
    const auto client = start(unguarded(alice_), "write", "client_alice", "honest", "secret");
    EXPECT_TRUE(hears(*rogue, "secret")) << "is what the guard stops";
  }
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "hello"), "hello");
  server_.kill();
  for (const char* const way : {"changed", "hidden"}) {
    const auto rogue = start(bob(), "serve", "client_alice", way);
    const std::string answer = ask(requester, "secret", 1500ms);
    EXPECT_NE(answer.find(" ms (domain "), std::string::npos) << answer;  // nobody answered
    EXPECT_FALSE(rogue->has_output()) << way;
  }
}

}  // namespace
}  // namespace kinship::dds::intruder_test
