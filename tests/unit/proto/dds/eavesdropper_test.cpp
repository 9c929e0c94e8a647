// What somebody hears who sees every packet, and what becomes of packets that he sends again. Each
// first without security, where both succeed.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/loopback_capture.hpp"
#include "tests/unit/proto/dds/secured_fleet.hpp"

namespace kinship::dds::eavesdropper_test {
namespace {

using namespace std::chrono_literals;
using Messages = std::vector<test::CapturedMessage>;

class Eavesdropper : public test::SecuredFleet {
 protected:
  void SetUp() override {
    if (!capture_)
      GTEST_SKIP() << "this process may not capture packets";
    ASSERT_EQ(server_.read_line(), "ready");
  }

  const std::optional<test::LoopbackCapture> capture_ = test::LoopbackCapture::start();
  const test::ReservedDomain open_;  // without security
  test::ChildProcess open_server_{{KINSHIP_ECHO_SERVER, std::to_string(open_.number())}};
};

bool has(const Messages& messages, const std::string& text) {
  return std::ranges::any_of(messages, [&](const test::CapturedMessage& message) {
    return message.bytes.find(text) != std::string::npos;
  });
}

/// How often the text is in it.
std::size_t count(const std::string& in, const std::string& text) {
  std::size_t found = 0;
  for (std::size_t at = in.find(text); at != std::string::npos; at = in.find(text, at + 1))
    ++found;
  return found;
}

/// Sends the requests of a session again, as they were and under further numbers.
void replay(const Messages& session, std::uint16_t port) {
  for (const test::CapturedMessage& message : session) {
    if (message.port != port)
      continue;
    test::send_again(message);
    for (std::uint32_t more = 1; more < 4; ++more)
      if (const auto again = test::renumbered(message, more))
        test::send_again(*again);
  }
}

TEST_F(Eavesdropper, HasNothingDoneAgain) {
  ASSERT_EQ(open_server_.read_line(), "ready");
  const auto times_done = [&](std::uint32_t domain, const std::filesystem::path& credentials) {
    const Participant participant({.domain = domain, .security = credentials});
    AdminRequester requester(participant, Uuid::random());
    capture_->take();
    EXPECT_EQ(ask(requester, "retire"), "retire");
    replay(capture_->take(), server_ports(domain)[1]);
    // Another writer's: what was replayed is before it at the server.
    const Participant second({.domain = domain, .security = credentials});
    AdminRequester other(second, Uuid::random());
    return count(ask(other, "log"), "retire");
  };
  EXPECT_GT(times_done(open_.number(), {}), 1U);
  EXPECT_EQ(times_done(domain_.number(), alice_), 1U);
}

/// By the writer of these messages. DDS Security leaves them open, for nobody knows the other one's
/// key yet: who changes them can keep a client away (Limits of proto/security).
bool is_of_handshake(const test::CapturedMessage& message) {
  constexpr std::string_view kStatelessWriter("\x00\x02\x01\xc3", 4);
  return message.bytes.find(kStatelessWriter) != std::string::npos;
}

/// Sends the requests of a session again under so many further numbers, with another text of that
/// length.
void forge(const Messages& session, std::uint16_t port, const std::string& was,
           const std::string& text, std::uint32_t numbers) {
  for (const test::CapturedMessage& message : session) {
    const auto at = message.bytes.find(was);
    if (message.port != port || at == std::string::npos)
      continue;
    test::CapturedMessage forged = message;
    forged.bytes.replace(at, text.size(), text);
    for (std::uint32_t more = 1; more <= numbers; ++more)
      if (const auto next = test::renumbered(forged, more))
        test::send_again(*next);
  }
}

TEST_F(Eavesdropper, DisturbsNobodyWithPacketsThatHeChanged) {
  constexpr int kPackets = 20'000;
  {  // without security he puts words into anybody's mouth
    ASSERT_EQ(open_server_.read_line(), "ready");
    const Participant participant({.domain = open_.number()});
    AdminRequester requester(participant, Uuid::random());
    Messages session;  // a capture loses packets while others flood the loopback interface
    while (!has(session, "before")) {
      capture_->take();
      ASSERT_EQ(ask(requester, "before"), "before");
      session = capture_->take();
    }
    const Participant second({.domain = open_.number()});
    AdminRequester other(second, Uuid::random());
    // The client's own resend may have the first number, and a request of which another copy waits
    // is left out: so it is tried under more and more numbers.
    const auto end = std::chrono::steady_clock::now() + 10s;
    std::string log;
    for (std::uint32_t numbers = 1;
         count(log, "forged") == 0 && std::chrono::steady_clock::now() < end; ++numbers) {
      forge(session, server_ports(open_.number())[1], "before", "forged", numbers);
      log = ask(other, "log");
    }
    EXPECT_GT(count(log, "forged"), 0U);
  }
  capture_->take();
  const Participant participant = join(alice_);
  AdminRequester requester(participant, Uuid::random());
  ASSERT_EQ(ask(requester, "before"), "before");
  Messages packets = capture_->take();
  const auto ports = server_ports(domain_.number());
  std::erase_if(packets, [&](const test::CapturedMessage& message) {
    return std::ranges::find(ports, message.port) == ports.end() || message.bytes.size() < 24 ||
           is_of_handshake(message);
  });
  ASSERT_GT(packets.size(), 10U);
  std::mt19937_64 generator(1);
  for (int i = 0; i < kPackets; ++i) {
    test::CapturedMessage changed = packets[generator() % packets.size()];
    for (std::uint64_t changes = 1 + generator() % 4; changes > 0; --changes)
      changed.bytes[20 + generator() % (changed.bytes.size() - 20)] =
          static_cast<char>(generator());
    test::send_again(changed);
    if (i % 2000 == 0) {
      EXPECT_EQ(ask(requester, "meanwhile"), "meanwhile");
    }
  }
  EXPECT_EQ(ask(requester, "after"), "after");
  std::string log = ask(requester, "log");
  for (const char* const asked : {"alice:before ", "alice:meanwhile ", "alice:after "})
    for (auto at = log.find(asked); at != std::string::npos; at = log.find(asked))
      log.erase(at, std::strlen(asked));
  EXPECT_EQ(log, "") << "nothing was done but what was asked for";
}

}  // namespace
}  // namespace kinship::dds::eavesdropper_test
