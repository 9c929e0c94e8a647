// Client against repliers in this process, over loopback.

#include "client/link/client.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "proto/dds/replier.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::client_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kSeed = 37;

FetchRequest request(std::chrono::milliseconds deadline) {
  FetchRequest request;
  request.task = "shelf_pick";
  request.deadline = deadline;
  return request;
}

FetchReply status(FetchStatus status, std::chrono::milliseconds retry_after = 0ms) {
  FetchReply reply;
  reply.status = status;
  reply.retry_after = retry_after;
  return reply;
}

/// A server that answers fetches by a function and stores every report.
class Server {
 public:
  using Fetch = std::function<FetchReply(const FetchRequest&)>;

  Server(std::uint32_t domain, Fetch fetch)
      : participant_({.domain = domain, .role = dds::Role::Server}),
        loop_(participant_),
        fetch_(participant_, loop_,
               [fetch = std::move(fetch)](const FetchRequest& wanted, const auto& answer) {
                 answer(fetch(wanted));
               }),
        report_(participant_, loop_,
                [epoch = Uuid::random()](const ReportRequest& batch, const auto& answer) {
                  ReportReply reply{epoch, batch.refused};
                  for (const Attempt& attempt : batch.attempts)
                    reply.receipts.push_back({attempt.report_uuid, ReceiptStatus::Stored, ""});
                  answer(reply);
                }),
        thread_([this] { loop_.run([] { return Clock::time_point::max(); }); }) {}
  ~Server() {
    loop_.stop();
    thread_.join();
  }

 private:
  dds::Participant participant_;
  dds::WaitLoop loop_;
  dds::Replier<codec::FetchConversation> fetch_;
  dds::Replier<codec::ReportConversation> report_;
  std::thread thread_;
};

class ClientTest : public testing::Test {
 protected:
  ClientOptions options(std::chrono::milliseconds timeout = 5s) const {
    return {.domain = domain_.number(), .outbox = folder.path(), .timeout = timeout};
  }
  test::ReservedDomain domain_;
  test::TemporaryDirectory folder;
};

TEST_F(ClientTest, ReportThatTheServerWouldRefuseIsNotWritten) {
  test::RandomValues values(kSeed);
  Client client(options());
  Attempt attempt = values.attempt();
  attempt.task = "bin to shelf";
  EXPECT_THROW(client.report(attempt), Failure);
  EXPECT_EQ(client.outbox().pending, 0U);
}

TEST_F(ClientTest, FetchAsksAgainAfterBusyAndPending) {
  std::atomic<int> calls = 0;
  Server server(domain_.number(), [&](const auto&) {
    const int call = ++calls;
    return call == 1   ? status(FetchStatus::Busy, 50ms)
           : call == 2 ? status(FetchStatus::Pending)
                       : status(FetchStatus::NoExperience);
  });
  Client client(options());
  EXPECT_EQ(client.fetch(request(10s))->status, FetchStatus::NoExperience);
  EXPECT_EQ(calls, 3);
}

TEST_F(ClientTest, BusyForLongerThanTheDeadlineIsTheReply) {
  Server server(domain_.number(), [](const auto&) { return status(FetchStatus::Busy, 60s); });
  Client client(options());
  const auto start = Clock::now();
  EXPECT_EQ(client.fetch(request(50s))->status, FetchStatus::Busy);
  EXPECT_LT(Clock::now() - start, 40s);
}

TEST_F(ClientTest, FetchWithoutDeadlineTakesTheFirstReply) {
  std::atomic<int> calls = 0;
  Server server(domain_.number(), [&](const FetchRequest& wanted) {
    ++calls;
    EXPECT_EQ(wanted.deadline, 0ms);
    return status(FetchStatus::Pending);
  });
  Client client(options());
  EXPECT_EQ(client.fetch(request(0ms))->status, FetchStatus::Pending);
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientTest, ServerIsGivenLessThanTheDeadline) {
  std::atomic<std::int64_t> given = 0;
  Server server(domain_.number(), [&](const FetchRequest& wanted) {
    given = wanted.deadline.count();
    return status(FetchStatus::NoExperience);
  });
  Client client(options());
  ASSERT_TRUE(client.fetch(request(60s)));
  EXPECT_LE(given, 59'800);
  EXPECT_GT(given, 30'000);
}

TEST_F(ClientTest, WithoutAServerEverythingEndsInTime) {
  Client client(options(200ms));
  const auto start = Clock::now();
  EXPECT_EQ(client.fetch(request(200ms)).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(client.admin({}).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(client.register_robot(test::RandomValues(kSeed).robot_description()).error().code,
            ErrorCode::Unavailable);
  EXPECT_LT(Clock::now() - start, 20s);
}

TEST_F(ClientTest, DescriptionOfARobotIsKeptAlsoWithoutAServer) {
  Client client(options(50ms));
  EXPECT_FALSE(client.register_robot(test::model_description("panda")));
  const std::string digest = test::model_chain("panda").digest().hex();
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "robots" / (digest + ".json")));
}

TEST_F(ClientTest, ClientWithoutOutboxTouchesNoneAndCannotReport) {
  Server server(domain_.number(), [](const auto&) { return status(FetchStatus::NoExperience); });
  ClientOptions looks = options();
  looks.outbox = folder.path() / "untouched";
  looks.has_outbox = false;
  Client client(looks);
  EXPECT_TRUE(client.fetch(request(10s)));
  EXPECT_THROW(client.report(test::RandomValues(kSeed).attempt()), std::logic_error);
  EXPECT_EQ(client.flush(10s).pending, 0U);
  EXPECT_FALSE(std::filesystem::exists(looks.outbox));
}

TEST_F(ClientTest, TwoClientsMayShareAnOutbox) {
  Server server(domain_.number(), [](const auto&) { return status(FetchStatus::NoExperience); });
  Client one(options(100ms));
  Client other(options());
  one.register_robot(test::model_description("panda"));
  for (std::uint64_t i = 0; i < 10; ++i)
    (i % 2 == 0 ? one : other)
        .report(test::panda_attempt(test::model_chain("panda").digest(), "sweep", i));
  EXPECT_EQ(other.flush(15s).pending, 0U);
}

TEST_F(ClientTest, ReportsThatTheirRobotCannotHaveMadeAreNotWritten) {
  const Attempt attempt = test::panda_attempt(test::model_chain("panda").digest(), "sweep", 1);
  const auto refusal_of = [](Client& client, const Attempt& given) {
    try {
      client.report(given);
      return Error{ErrorCode::Internal, "it was taken"};
    } catch (const Failure& failure) {
      return failure.error();
    }
  };
  Client client(options(100ms));
  const Error unknown = refusal_of(client, attempt);
  EXPECT_EQ(unknown.code, ErrorCode::NotFound);
  EXPECT_NE(unknown.message.find(attempt.robot.short_hex()), std::string::npos) << unknown.message;
  EXPECT_FALSE(client.register_robot(test::model_description("panda")));
  Attempt other = attempt;
  other.path.emplace(Eigen::MatrixXd::Zero(6, 2));
  Client later(options(100ms));
  for (Client* const each : {&client, &later}) {
    const Error wrong = refusal_of(*each, other);
    EXPECT_EQ(wrong.code, ErrorCode::InvalidInput);
    EXPECT_EQ(wrong.message, "robot 'panda' (" + attempt.robot.short_hex() +
                                 ") has 7 joints, the report's path has 6");
  }
  EXPECT_EQ(client.outbox().pending, 0U);
  client.report(attempt);
  EXPECT_EQ(client.outbox().pending, 1U);
}

}  // namespace
}  // namespace kinship::link::client_test
