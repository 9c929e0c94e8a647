// Client and server in processes of their own, over loopback.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <future>
#include <string>

#include "proto/dds/qos.hpp"
#include "proto/dds/request_channel.hpp"
#include "proto/dds/requester.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::dds::processes_test {
namespace {

using namespace std::chrono_literals;
using AdminRequester = Requester<codec::AdminConversation>;

test::ChildProcess start_server(std::uint32_t domain) {
  return test::ChildProcess({KINSHIP_ECHO_SERVER, std::to_string(domain)});
}

AdminRequester::Clock::time_point in(std::chrono::milliseconds time) {
  return AdminRequester::Clock::now() + time;
}

AdminRequest echo(const std::string& text) {
  AdminRequest request;
  request.argument = text;
  return request;
}

/// Row of the reply, or the error's message.
std::string text_of(const Result<AdminReply>& reply) {
  if (!reply)
    return reply.error().message;
  return reply->rows.empty() ? reply->message : reply->rows.front();
}

TEST(Processes, CallWaitsForAServerThatStartsLater) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  AdminRequester requester(participant, Uuid::random());
  auto reply =
      std::async(std::launch::async, [&] { return requester.call(echo("late"), in(20s)); });
  EXPECT_EQ(reply.wait_for(200ms), std::future_status::timeout);
  test::ChildProcess server = start_server(domain.number());
  EXPECT_EQ(text_of(reply.get()), "late");
}

TEST(Processes, ClientsOfOnePartitionGetTheirOwnReplies) {
  const test::ReservedDomain domain;
  const Uuid one = Uuid::random();
  Uuid other = Uuid::random();
  while (reply_partition_of(one) != reply_partition_of(other))
    other = Uuid::random();
  const Participant participant({.domain = domain.number()});
  AdminRequester requester_one(participant, one);  // both count from 1
  AdminRequester requester_other(participant, other);
  test::ChildProcess server = start_server(domain.number());
  ASSERT_EQ(server.read_line(), "ready");
  for (int i = 0; i < 20; ++i) {
    auto reply =
        std::async(std::launch::async, [&] { return requester_one.call(echo("one"), in(10s)); });
    EXPECT_EQ(text_of(requester_other.call(echo("other"), in(10s))), "other");
    EXPECT_EQ(text_of(reply.get()), "one");
  }
}

TEST(Processes, RequestThatBreaksARuleIsRefusedByTheServer) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  RequestChannel line(participant, Uuid::random(), Wire<codec::AdminConversation>::topics());
  test::ChildProcess server = start_server(domain.number());
  const codec::Head head = line.next_head();
  codec::Message<kinship_wire_AdminRequest> message(head);  // by hand: encode() would refuse it
  char empty[] = "";
  message.wire.argument = message.wire.robot = message.wire.task = message.wire.cursor = empty;
  message.wire.verb = 1000;
  AdminReply reply;
  const auto outcome = line.call(head, &message.wire, in(10s), [&](const void* wire) {
    reply = codec::decode(*static_cast<const kinship_wire_AdminReply*>(wire)).value_or_throw();
  });
  EXPECT_EQ(outcome, RequestChannel::Outcome::Answered);
  EXPECT_EQ(reply.status, AdminStatus::Refused);
  EXPECT_EQ(reply.message,
            "verb: 1000 is not between 0 and " + std::to_string(static_cast<int>(kLastVerb)));
}

TEST(Processes, SecondServerOfADomainIsRefusedByName) {
  const test::ReservedDomain domain;
  test::ChildProcess first = start_server(domain.number());
  ASSERT_EQ(first.read_line(), "ready");
  test::ChildProcess second = start_server(domain.number());
  const std::string line = second.read_line();
  const std::string name = std::to_string(domain.number());
  const std::string port = std::to_string(discovery_port(domain.number()));
  EXPECT_EQ(line.find("error: domain " + name + ": cannot join as its server at UDP port " + port),
            0U)
      << line;
  EXPECT_EQ(second.wait(), 1);
}

TEST(Processes, LargeReplyArrivesWhole) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  AdminRequester requester(participant, Uuid::random());
  test::ChildProcess server = start_server(domain.number());
  AdminRequest request;
  request.verb = AdminVerb::ListPaths;
  request.limit = 300;
  EXPECT_EQ(text_of(requester.call(request, in(10s))), std::string(300'000, 'x'));
}

TEST(Processes, ReplyThatIsTooLargeBecomesARefusal) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  AdminRequester requester(participant, Uuid::random());
  test::ChildProcess server = start_server(domain.number());
  AdminRequest request;
  request.verb = AdminVerb::ListPaths;
  request.limit = 600;
  const auto reply = requester.call(request, in(10s));
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->status, AdminStatus::Refused);
  EXPECT_EQ(reply->message, "rows: 600000 bytes exceed 524288");
}

/// What a process forked from this one says of joining a domain; "joined" if it does.
std::string said_in_a_fork(std::uint32_t domain) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    std::string text = "joined";
    try {
      const Participant participant({.domain = domain});
    } catch (const Failure& failure) {
      text = failure.error().message;
    }
    const auto written = write(ends[1], text.data(), text.size());
    _exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string text(4096, ' ');
  const auto length = read(ends[0], text.data(), text.size());
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
}

TEST(Processes, AForkedProcessOfAMemberSaysAtOnceWhatToUse) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  EXPECT_NE(said_in_a_fork(domain.number()).find("\"spawn\""), std::string::npos);
}

TEST(Processes, AForkedProcessOfOneThatHasLeftItsDomainsJoins) {
  const test::ReservedDomain domain;
  { const Participant participant({.domain = domain.number()}); }
  EXPECT_EQ(said_in_a_fork(domain.number()), "joined");
}

}  // namespace
}  // namespace kinship::dds::processes_test
