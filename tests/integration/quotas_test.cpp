// A greedy client beside a polite one, with kinshipd as a process: who takes too much is told when
// to come again and loses nothing, who does not notices nothing.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "proto/dds/participant.hpp"
#include "proto/dds/requester.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/integration/admin_commands.hpp"

namespace kinship::quotas_test {
namespace {

using admin_commands_test::Answer;
using admin_commands_test::expect_has;
using admin_commands_test::Server;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

class Quotas : public testing::Test {
 protected:
  static Digest register_panda(link::Client& client) {
    return client.register_robot(test::model_description("panda")).value_or_throw().robot;
  }
  static std::vector<Attempt> attempts(const Digest& panda, std::uint64_t count,
                                       const std::string& task = "sweep") {
    std::vector<Attempt> made;
    for (std::uint64_t i = 0; i < count; ++i)
      made.push_back(test::panda_attempt(panda, task, i));
    return made;
  }
  static std::vector<ClientUse> clients_of(const Server& server) {
    const Answer answer = server.ends(0, "status --clients --json");
    std::vector<ClientUse> clients;
    const nlohmann::json document = nlohmann::json::parse(answer.out);
    for (const auto& row : document.at("rows"))
      clients.push_back(json::row_from_json<ClientUse>(row.dump()).value_or_throw());
    return clients;
  }
  static std::uint64_t count(const std::vector<Receipt>& receipts, ReceiptStatus status) {
    return static_cast<std::uint64_t>(std::ranges::count(receipts, status, &Receipt::status));
  }

  test::TemporaryDirectory folder_;
};

TEST_F(Quotas, AGreedyClientWaitsAndLosesNothingWhileItsNeighbourIsServed) {
  const Server server(folder_ / "fleet.db", {"--client-attempts-per-s", "10"});
  const auto greedy = server.client(folder_ / "greedy");
  const auto polite = server.client(folder_ / "polite");
  const Digest panda = register_panda(*greedy);
  static_cast<void>(register_panda(*polite));
  // 100 at once are allowed and 150 are let in as one batch: the next ones are owed for 6 s.
  const auto receipts = greedy->deliver(attempts(panda, 150)).value_or_throw();
  ASSERT_EQ(count(receipts, ReceiptStatus::Stored), 150U);
  for (const Attempt& attempt : attempts(panda, 10))
    greedy->report(attempt);
  const auto give_up = Clock::now() + seconds(60);
  while (greedy->outbox().problem.empty() && Clock::now() < give_up)
    greedy->flush(std::chrono::milliseconds(20));
  EXPECT_NE(greedy->outbox().problem.find("over its quota of 10 attempts a second"),
            std::string::npos)
      << greedy->outbox().problem;

  for (const Attempt& attempt : attempts(panda, 10))
    polite->report(attempt);
  EXPECT_EQ(polite->flush(seconds(60)).accepted, 10U);
  EXPECT_EQ(polite->outbox().problem, "");
  EXPECT_EQ(greedy->outbox().pending, 10U) << "its neighbour did not wait for it";

  const link::Client::OutboxState state = greedy->flush(seconds(60));
  EXPECT_EQ(state.pending, 0U) << state.problem;
  EXPECT_EQ(state.accepted, 10U);
  EXPECT_EQ(state.refused, 0U);
  std::uint64_t greedy_rows = 0, polite_rows = 0;
  for (const ClientUse& client : clients_of(server)) {
    if (client.attempts == 160) {
      ++greedy_rows;
      EXPECT_GE(client.refused, 1U);
      EXPECT_LE(client.refused, 4U) << "it came again when it was told to, not before";
      EXPECT_EQ(client.refused_for, "attempts");
      EXPECT_EQ(client.robots, std::vector<std::string>{"panda"});
      EXPECT_EQ(client.stored_bytes, 150 * 7 * 4 * sizeof(double)) << "the others were known";
      EXPECT_EQ(client.created_tasks, 1U);
    }
    if (client.attempts == 10) {
      ++polite_rows;
      EXPECT_EQ(client.refused, 0U);
      EXPECT_EQ(client.created_tasks, 0U);
    }
  }
  EXPECT_EQ(greedy_rows, 1U);
  EXPECT_EQ(polite_rows, 1U);
  EXPECT_NE(server.kinship("status").out.find("client over quota"), std::string::npos);
}

TEST_F(Quotas, NewRobotsAndTasksAreSoManyADayAndSayWhen) {
  const Server server(folder_ / "fleet.db",
                      {"--client-robots-per-day", "1", "--client-tasks-per-day", "1"});
  const auto client = server.client(folder_ / "outbox");
  const Digest panda = register_panda(*client);
  const RegisterReply second =
      client->register_robot(test::model_description("ur10e")).value_or_throw();
  EXPECT_EQ(second.status, RegisterStatus::Refused);
  EXPECT_EQ(second.retry_after, seconds(60)) << "a day is longer than a client is kept waiting";
  expect_has(second.message, "1 new robots a day");

  ASSERT_EQ(count(client->deliver(attempts(panda, 3)).value_or_throw(), ReceiptStatus::Stored), 3U);
  const dds::Participant participant({.domain = server.domain(), .server = "127.0.0.1"});
  dds::Requester<codec::ReportConversation> line(participant, Uuid::random());
  const auto first = line.call({attempts(panda, 1, "first"), {}}, Clock::now() + seconds(30));
  EXPECT_EQ(first.value().receipts.at(0).status, ReceiptStatus::Stored) << "another client's day";
  const ReportReply other =
      line.call({attempts(panda, 1, "second"), {}}, Clock::now() + seconds(30)).value_or_throw();
  ASSERT_EQ(other.receipts.size(), 1U);
  EXPECT_EQ(other.receipts[0].status, ReceiptStatus::TryAgain);
  EXPECT_NE(other.receipts[0].message.find("1 new tasks a day"), std::string::npos);
  EXPECT_EQ(other.retry_after, seconds(60));
  const auto known =
      line.call({{test::panda_attempt(panda, "sweep", 77)}, {}}, Clock::now() + seconds(30));
  EXPECT_EQ(known.value().receipts.at(0).status, ReceiptStatus::Stored)
      << "what is known already may be reported";
}

TEST_F(Quotas, WhatAClientIsSentCountsToo) {
  const Server server(folder_ / "fleet.db", {"--client-mb-per-s", "0.001"});
  const auto client = server.client(folder_ / "outbox");
  FetchRequest request;
  request.task = "sweep";
  FetchReply reply;  // each has some 500 bytes, and its request: 10 000 at once are allowed
  for (int i = 0; i < 100 && reply.status != FetchStatus::Busy; ++i)
    reply = client->fetch(request).value_or_throw();
  EXPECT_EQ(reply.status, FetchStatus::Busy);
  EXPECT_GT(reply.retry_after.count(), 0);
  expect_has(reply.message, "0.001 MB a second");
}

/// Processor time that a process has taken.
double cpu_s(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string field;
  double ticks = 0;
  constexpr int kUserTicks = 14, kSystemTicks = 15;  // proc(5)
  for (int i = 1; i <= kSystemTicks && file >> field; ++i)
    if (i >= kUserTicks)
      ticks += std::stod(field);
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

TEST_F(Quotas, AFloodThatIsRefusedCostsLessThanOneThatIsServed) {
  constexpr int kBatches = 60;
  const auto cost = [&](const std::string& store, const std::string& quota, bool is_served) {
    Server server(folder_.path() / store,
                  {"--client-attempts-per-s", quota, "--rehearsal-cpu", "0"});
    const Digest panda = register_panda(*server.client(folder_.path() / (store + ".outbox")));
    const dds::Participant participant({.domain = server.domain(), .server = "127.0.0.1"});
    dds::Requester<codec::ReportConversation> line(participant, Uuid::random());
    std::vector<ReportRequest> batches;
    for (int i = 0; i <= kBatches; ++i)
      batches.push_back({attempts(panda, 200), {}});
    static_cast<void>(line.call(batches.back(), Clock::now() + seconds(30)));
    const double before = cpu_s(server.process().pid());
    for (int i = 0; i < kBatches; ++i) {
      const auto reply =
          line.call(batches[static_cast<std::size_t>(i)], Clock::now() + seconds(30));
      EXPECT_EQ(reply.value().receipts.size(), is_served ? 200U : 0U);
      EXPECT_EQ(reply.value().retry_after.count() > 0, !is_served);
    }
    return cpu_s(server.process().pid()) - before;
  };
  const double refused = cost("refused.db", "1", false);
  const double served = cost("served.db", "0", true);
  RecordProperty("refused_s", std::to_string(refused));
  RecordProperty("served_s", std::to_string(served));
  EXPECT_LT(refused, served / 2) << refused << " s refused, " << served << " s served";
}

}  // namespace
}  // namespace kinship::quotas_test
