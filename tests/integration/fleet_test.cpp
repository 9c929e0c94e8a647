// The whole way: clients and kinshipd as processes of their own, over loopback DDS.

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::fleet_test {
namespace {

using std::chrono::seconds;

class Fleet : public testing::Test {
 protected:
  void start_server() {
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  }
  std::unique_ptr<link::Client> make_client(const char* outbox = "outbox") const {
    return std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain_.number(), .outbox = directory_ / outbox, .timeout = seconds(20)});
  }
  static Digest register_model(link::Client& client, const std::string& name) {
    const Result<RegisterReply> reply = client.register_robot(test::model_description(name));
    if (!reply)
      throw Failure(reply.error());
    EXPECT_NE(reply->status, RegisterStatus::Refused) << reply->message;
    return reply->robot;
  }
  static ServerStatus status_of(link::Client& client) {
    const AdminReply reply = client.admin({}).value_or_throw();
    return json::row_from_json<ServerStatus>(reply.rows.at(0)).value_or_throw();
  }
  static FetchRequest request_for(const Digest& robot) {
    FetchRequest request;
    request.task = "sweep";
    request.robot = robot;
    request.deadline = seconds(60);
    return request;
  }
  /// The reports of all paths that the server lists, page by page.
  static std::multiset<Uuid> listed_paths(link::Client& client) {
    std::multiset<Uuid> listed;
    AdminRequest request;
    request.verb = AdminVerb::ListPaths;
    request.limit = 7;
    do {
      const AdminReply page = client.admin(request).value_or_throw();
      for (const std::string& row : page.rows)
        listed.insert(json::row_from_json<PathSummary>(row).value_or_throw().report_uuid);
      request.cursor = page.next_cursor;
    } while (!request.cursor.empty());
    return listed;
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
};

TEST_F(Fleet, WhatOneRobotReportedGuidesAnotherAlsoAfterARestart) {
  start_server();
  const auto client = make_client();
  const Digest panda = register_model(*client, "panda");
  const Digest ur10e = register_model(*client, "ur10e");
  EXPECT_EQ(client->fetch(request_for(ur10e))->status, FetchStatus::NoExperience);
  for (std::uint64_t i = 0; i < 6; ++i)
    client->report(test::panda_attempt(panda, "sweep", i));
  const link::Client::OutboxState outbox = client->flush(seconds(30));
  ASSERT_EQ(outbox.pending, 0U) << outbox.problem;
  EXPECT_EQ(outbox.accepted, 6U);

  const Result<FetchReply> fetched = client->fetch(request_for(ur10e));
  ASSERT_TRUE(fetched) << fetched.error().message;
  ASSERT_EQ(fetched->status, FetchStatus::Ready) << fetched->message;
  const Distribution& distribution = *fetched->distribution;
  EXPECT_EQ(distribution.mixture->dimension(), 6);
  ASSERT_EQ(distribution.sources.size(), 1U);
  EXPECT_EQ(distribution.sources[0].label, "panda");
  EXPECT_EQ(distribution.sources[0].paths, 6U);

  EXPECT_EQ(server_->terminate(), 0);
  start_server();
  FetchRequest at_once = request_for(ur10e);
  at_once.deadline = seconds(0);
  const Result<FetchReply> again = client->fetch(at_once);
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->status, FetchStatus::Ready) << again->message;
  EXPECT_EQ(again->distribution->id, distribution.id);
  EXPECT_EQ(again->distribution->revision, distribution.revision);
  EXPECT_EQ(again->distribution->mixture->means(), distribution.mixture->means());
  EXPECT_EQ(status_of(*client).fits, 0U);
}

TEST_F(Fleet, AnUnknownRobotsReportsWaitUntilItIsRegistered) {
  start_server();
  const auto client = make_client();
  client->report(test::panda_attempt(test::model_chain("panda").digest(), "sweep", 1));
  const auto waiting = client->flush(seconds(1));
  EXPECT_EQ(waiting.refused, 0U);
  EXPECT_EQ(waiting.pending, 1U);
  EXPECT_EQ(status_of(*client).attempts, 0U);
  register_model(*client, "panda");
  EXPECT_EQ(client->flush(seconds(30)).accepted, 1U);
  EXPECT_EQ(status_of(*client).attempts, 1U);
}

TEST_F(Fleet, EveryListIsTheSameInPages) {
  start_server();
  const auto client = make_client();
  const Digest panda = register_model(*client, "panda");
  std::multiset<Uuid> reported;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const Attempt attempt = test::panda_attempt(panda, "sweep", i);
    reported.insert(attempt.report_uuid);
    client->report(attempt);
  }
  ASSERT_EQ(client->flush(seconds(30)).accepted, 20U);
  EXPECT_EQ(listed_paths(*client), reported);
}

}  // namespace
}  // namespace kinship::fleet_test
