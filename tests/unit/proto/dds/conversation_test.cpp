// Requester and replier in one process: who is called how often, and when.

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "proto/dds/replier.hpp"
#include "proto/dds/requester.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::dds::conversation_test {
namespace {

using namespace std::chrono_literals;
using Conversation = codec::AdminConversation;
using AdminAnswer = Answer<Conversation>;
using Clock = WaitLoop::Clock;

AdminRequest echo(const std::string& text) {
  AdminRequest request;
  request.argument = text;
  return request;
}

AdminReply row(const std::string& text) {
  AdminReply reply;
  reply.status = AdminStatus::Ok;
  reply.rows = {text};
  return reply;
}

/// A server with a handler on a thread, and a requester, on a domain of their own.
class Pair {
 public:
  explicit Pair(Replier<Conversation>::Handler handler, Replier<Conversation>::Gate gate = {})
      : server_({.domain = domain_.number(), .role = Role::Server}),
        loop_(server_),
        replier_(server_, loop_, std::move(handler), std::move(gate)),
        client_({.domain = domain_.number(), .role = Role::Client}),
        requester_(client_, Uuid::random()),
        thread_([this] { loop_.run([] { return Clock::time_point::max(); }); }) {}
  ~Pair() {
    loop_.stop();
    thread_.join();
  }

  Result<AdminReply> call(const std::string& text, std::chrono::milliseconds time = 10s) {
    return requester_.call(echo(text), Clock::now() + time);
  }
  void cancel() { requester_.cancel(); }

 private:
  test::ReservedDomain domain_;
  Participant server_;
  WaitLoop loop_;
  Replier<Conversation> replier_;
  Participant client_;
  Requester<Conversation> requester_;
  std::thread thread_;
};

/// Answers that a handler has put aside.
class Held {
 public:
  void hold(const AdminAnswer& answer) {
    const std::lock_guard lock(mutex_);
    answers_.push_back(answer);
    if (answers_.size() == 1)
      first_.set_value();
  }
  void wait_for_first() { first_.get_future().wait(); }
  std::size_t size() {
    const std::lock_guard lock(mutex_);
    return answers_.size();
  }
  void answer_all(const AdminReply& reply) {
    const std::lock_guard lock(mutex_);
    for (const AdminAnswer& answer : answers_)
      answer(reply);
  }

 private:
  std::mutex mutex_;
  std::vector<AdminAnswer> answers_;
  std::promise<void> first_;
};

TEST(Conversation, AnswerMayComeLaterFromAnotherThreadAndResendsAreDropped) {
  Held held;
  Pair pair([&](const AdminRequest&, const AdminAnswer& answer) { held.hold(answer); });
  auto reply = std::async(std::launch::async, [&] { return pair.call("x"); });
  held.wait_for_first();
  EXPECT_EQ(reply.wait_for(600ms), std::future_status::timeout);  // resent after 100 and 400 ms
  EXPECT_EQ(held.size(), 1U);
  held.answer_all(row("late"));
  EXPECT_EQ(reply.get()->rows.front(), "late");
}

TEST(Conversation, AGateAnswersInThePlaceOfTheHandlerAndIsNotAskedOfResends) {
  Held held;
  std::atomic<int> asked = 0, handled = 0;
  std::atomic<bool> is_open = false;
  const auto gate = [&](const Caller& caller,
                        const codec::RequestSize& size) -> std::optional<AdminReply> {
    EXPECT_FALSE(caller.client.empty());
    EXPECT_GT(size.bytes, 0U);
    ++asked;
    if (is_open)
      return std::nullopt;
    AdminReply busy;
    busy.status = AdminStatus::Failed;
    busy.retry_after = 1500ms;
    return busy;
  };
  Pair pair(
      [&](const AdminRequest&, const AdminAnswer& answer) {
        ++handled;
        held.hold(answer);
      },
      gate);
  EXPECT_EQ(pair.call("x")->retry_after, 1500ms);
  EXPECT_EQ(handled, 0);
  is_open = true;
  const int before = asked;
  auto reply = std::async(std::launch::async, [&] { return pair.call("y"); });
  held.wait_for_first();
  EXPECT_EQ(reply.wait_for(600ms), std::future_status::timeout);  // resent after 100 and 400 ms
  EXPECT_EQ(asked, before + 1);
  held.answer_all(row("late"));
  EXPECT_EQ(reply.get()->rows.front(), "late");
}

TEST(Conversation, RequestWhoseAnswerWasDroppedIsHandledAnew) {
  std::atomic<int> calls = 0;
  Pair pair([&](const AdminRequest&, const AdminAnswer& answer) {
    if (++calls > 1)
      answer(row("second time"));
  });
  EXPECT_EQ(pair.call("x")->rows.front(), "second time");
}

TEST(Conversation, OnlyTheFirstAnswerCounts) {
  Pair pair([](const AdminRequest& request, const AdminAnswer& answer) {
    answer(row("first " + request.argument));
    answer(row("second " + request.argument));
  });
  EXPECT_EQ(pair.call("a")->rows.front(), "first a");
  EXPECT_EQ(pair.call("b")->rows.front(), "first b");
}

TEST(Conversation, CallsOfSeveralThreadsRunSideBySide) {
  Held held;
  Pair pair([&](const AdminRequest& request, const AdminAnswer& answer) {
    if (request.argument == "slow")
      held.hold(answer);
    else
      answer(row(request.argument));
  });
  auto slow = std::async(std::launch::async, [&] { return pair.call("slow"); });
  held.wait_for_first();
  std::vector<std::future<int>> others;
  for (int thread = 0; thread < 4; ++thread)
    others.push_back(std::async(std::launch::async, [&pair, thread] {
      int right = 0;
      for (int i = 0; i < 50; ++i) {
        const std::string text = std::to_string(100 * thread + i);
        const auto reply = pair.call(text);
        if (reply && reply->rows.front() == text)
          ++right;
      }
      return right;
    }));
  for (auto& other : others)
    EXPECT_EQ(other.get(), 50);
  held.answer_all(row("done"));
  EXPECT_EQ(slow.get()->rows.front(), "done");
}

TEST(Conversation, FailureOfTheHandlerIsTheReply) {
  Pair pair([](const AdminRequest&, const AdminAnswer&) {
    throw Failure(ErrorCode::NotFound, "no robot 'x'");
  });
  const auto reply = pair.call("x");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, AdminStatus::NotFound);
  EXPECT_EQ(reply->message, "no robot 'x'");
}

TEST(Conversation, CancelEndsACallAtOnce) {
  Held held;
  Pair pair([&](const AdminRequest&, const AdminAnswer& answer) { held.hold(answer); });
  auto reply = std::async(std::launch::async, [&] { return pair.call("x", 60s); });
  held.wait_for_first();
  pair.cancel();
  EXPECT_EQ(reply.get().error().code, ErrorCode::Unavailable);
  EXPECT_FALSE(pair.call("y", 60s));
}

TEST(Conversation, WithoutAServerACallEndsAtItsDeadline) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  Requester<Conversation> requester(participant, Uuid::random());
  const auto start = Clock::now();
  const auto reply = requester.call(echo("x"), start + 300ms);
  EXPECT_GE(Clock::now() - start, 300ms);
  EXPECT_LT(Clock::now() - start, 20s);
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, ErrorCode::Unavailable);
  EXPECT_EQ(reply.error().message.find("admin: no server answered within 3"), 0U)
      << reply.error().message;
}

TEST(Conversation, WithoutAServerTheMessageSaysThatCycloneddsUriReplacesTheConfiguration) {
  const test::ReservedDomain domain;
  setenv("CYCLONEDDS_URI", "<CycloneDDS/>", 1);  // NOLINT(concurrency-mt-unsafe)
  std::string message;
  {
    const Participant participant({.domain = domain.number()});
    Requester<Conversation> requester(participant, Uuid::random());
    message = requester.call(echo("x"), Clock::now() + 100ms).error().message;
  }
  setenv("CYCLONEDDS_URI", "file:///nowhere/broken.xml", 1);  // NOLINT(concurrency-mt-unsafe)
  std::string refusal;
  try {
    const Participant participant({.domain = domain.number()});
  } catch (const Failure& failure) {
    refusal = failure.error().message;
  }
  unsetenv("CYCLONEDDS_URI");  // NOLINT(concurrency-mt-unsafe)
  EXPECT_NE(message.find("CYCLONEDDS_URI is set ('<CycloneDDS/>') and replaces"), std::string::npos)
      << message;
  EXPECT_NE(refusal.find("file:///nowhere/broken.xml"), std::string::npos) << refusal;
}

TEST(Conversation, RequestThatBreaksARuleIsNotSent) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  Requester<Conversation> requester(participant, Uuid::random());
  AdminRequest request;
  request.limit = 0;
  EXPECT_EQ(requester.call(request, Clock::now() + 60s).error().code, ErrorCode::InvalidInput);
}

TEST(Conversation, AnswerAfterTheReplierIsGoneDoesNothing) {
  std::optional<AdminAnswer> kept;
  {
    std::promise<void> arrived;
    Pair pair([&](const AdminRequest&, const AdminAnswer& answer) {
      kept = answer;
      arrived.set_value();
    });
    auto reply = std::async(std::launch::async, [&] { return pair.call("x", 60s); });
    arrived.get_future().wait();
    pair.cancel();
    reply.wait();
  }
  (*kept)(row("too late"));
}

TEST(WaitLoop, WakesWhenItIsToldToAndWhenItIsTime) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number(), .role = Role::Server});
  WaitLoop loop(participant);
  std::promise<void> begun;
  int calls = 0;
  std::thread thread([&] {
    loop.run([&] {
      if (++calls == 1)
        begun.set_value();
      if (calls == 2)
        return Clock::now() + 20ms;  // woken by wake(); then by the time
      if (calls == 3)
        loop.stop();
      return Clock::time_point::max();
    });
  });
  begun.get_future().wait();
  loop.wake();
  thread.join();
  EXPECT_EQ(calls, 3);
}

TEST(WaitLoop, DoesNotRunAfterStop) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number(), .role = Role::Server});
  WaitLoop loop(participant);
  loop.stop();
  loop.run([]() -> Clock::time_point { throw std::logic_error("not expected"); });
}

}  // namespace
}  // namespace kinship::dds::conversation_test
