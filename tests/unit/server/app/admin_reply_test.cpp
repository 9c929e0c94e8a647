#include "server/app/admin_reply.hpp"

#include <gtest/gtest.h>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::app::admin_reply_test {
namespace {

TaskSummary task(const std::string& name) {
  TaskSummary summary;
  summary.task = name;
  return summary;
}

TEST(AdminReply, RowsAreTheDocumentsThatClientsRead) {
  service::AdminPage page;
  page.status = AdminStatus::Ok;
  page.next_cursor = "17";
  page.rows.emplace_back(task("shelf"));
  page.rows.emplace_back(task("bin"));
  const AdminReply reply = to_reply(page);
  EXPECT_EQ(reply.status, AdminStatus::Ok);
  EXPECT_EQ(reply.next_cursor, "17");
  ASSERT_EQ(reply.rows.size(), 2U);
  EXPECT_EQ(json::row_from_json<TaskSummary>(reply.rows[1]).value_or_throw().task, "bin");
}

TEST(AdminReply, EveryKindOfRowIsItsOwnDocument) {
  RobotDescription robot;
  robot.label = "panda";
  EXPECT_EQ(to_json(robot), json::to_json(robot));
  EXPECT_EQ(to_json(ServerStatus{}), json::to_json(ServerStatus{}));
  Distribution distribution;
  distribution.state = DistributionState::Failed;
  distribution.limits = Eigen::Matrix2Xd::Zero(2, 3);
  EXPECT_EQ(to_json(distribution), json::to_json(distribution));
  const Digest id = Digest::from_hex(std::string(64, 'a')).value();
  EXPECT_EQ(json::row_from_json<Eviction>(to_json(Eviction{id})).value_or_throw().id, id);
  const service::AdminRow exported = service::ExportedRobot{robot};
  EXPECT_TRUE(to_json(exported).starts_with(
      R"({"format":"kinship.experience-robot/1","robot_description":)"))
      << to_json(exported);
  EXPECT_EQ(to_json(service::TextLine{"1,2,3"}), "1,2,3");
}

TEST(AdminReply, MessagesOfFailuresArePassedOn) {
  service::AdminPage page;
  page.status = AdminStatus::NotFound;
  page.message = "no task 'bin'";
  const AdminReply reply = to_reply(page);
  EXPECT_EQ(reply.status, AdminStatus::NotFound);
  EXPECT_EQ(reply.message, "no task 'bin'");
}

TEST(AdminReply, TheRowsOfAPageHaveALimitTogether) {
  AdminReply reply;
  reply.rows = {std::string(kMaxPageBytes - 1, 'x'), "y"};
  EXPECT_TRUE(fits_page(reply));
  reply.rows.emplace_back("z");
  EXPECT_FALSE(fits_page(reply));
}

TEST(AdminReply, AListingThatDoesNotFitIsAskedForInHalves) {
  AdminRequest request;
  request.verb = AdminVerb::ListPaths;
  request.task = "shelf";
  request.limit = 1000;
  std::uint32_t rounds = 0;
  std::optional<AdminRequest> smaller = request;
  while ((smaller = for_fewer_rows(*smaller, smaller->limit))) {
    EXPECT_EQ(smaller->task, "shelf");
    ASSERT_LT(++rounds, 20U);
  }
  EXPECT_EQ(rounds, 9U);
}

TEST(AdminReply, WhatDoesNotFollowTheLimitIsNotAskedForAgain) {
  AdminRequest request;
  request.limit = 1000;
  request.verb = AdminVerb::ShowRobot;
  EXPECT_FALSE(for_fewer_rows(request, 2));
  request.verb = AdminVerb::ListRobots;
  request.limit = 1;
  EXPECT_FALSE(for_fewer_rows(request, 2));
}

TEST(AdminReply, TheRestOfARowIsAskedForAsItWas) {
  AdminRequest request;
  request.verb = AdminVerb::ExportPaths;
  request.limit = 100;
  request.cursor = "whatever";
  const AdminRequest rest = for_rest(request, {.inner = "17", .row = 0, .byte = 9, .check = 1});
  EXPECT_EQ(rest.cursor, "17");
  EXPECT_EQ(rest.limit, 1U);
  EXPECT_EQ(for_rest(request, {.inner = "17"}).limit, 100U);
  request.verb = AdminVerb::ShowRobot;
  EXPECT_EQ(for_rest(request, {.inner = "", .row = 1, .byte = 9, .check = 1}).limit, 100U);
}

}  // namespace
}  // namespace kinship::app::admin_reply_test
