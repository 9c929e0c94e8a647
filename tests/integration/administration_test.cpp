// What administrators ask of kinshipd, over loopback DDS: long rows, and what must stay gone.

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "client/link/admin_rows.hpp"
#include "proto/dds/participant.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/limits.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::administration_test {
namespace {

class Administrators : public testing::Test {
 protected:
  Administrators() { cell_.start(); }

  std::vector<std::string> rows(AdminVerb verb, const std::string& argument,
                                const std::string& task = {}) {
    return link::rows_of(cell_.client(), {.verb = verb, .argument = argument, .task = task})
        .value_or_throw();
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
};

TEST_F(Administrators, ALongRobotAndALongPathAreShownAndExportedWhole) {
  RobotDescription large = test::model_description("iiwa14");
  large.label = "large";
  large.urdf.insert(large.urdf.rfind("</robot>"),
                    "<!--" + std::string(kMaxUrdfBytes - large.urdf.size() - 7, 'x') + "-->");
  const Digest robot = cell_.client().register_robot(large).value_or_throw().robot;
  Attempt attempt = test::panda_attempt(robot, "long", 1);
  constexpr Eigen::Index kColumns = kMaxBatchBytes / sizeof(double) / 7;
  Eigen::MatrixXd waypoints(7, kColumns);
  for (Eigen::Index i = 0; i < kColumns; ++i)
    waypoints.col(i).setConstant(0.3 * std::sin(static_cast<double>(i)));
  attempt.path = Path(waypoints);
  cell_.client().report(attempt);
  ASSERT_EQ(cell_.client().flush(test::Cell::kEnough).accepted, 1U);

  const std::vector<std::string> shown = rows(AdminVerb::ShowRobot, "large");
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(json::robot_description_from_json(shown[1]).value_or_throw().urdf, large.urdf);
  EXPECT_TRUE(cell_.ask(AdminVerb::ShowRobot, "large").last_row_continues);

  const std::vector<std::string> exported = rows(AdminVerb::ExportPaths, "", "long");
  ASSERT_EQ(exported.size(), 2U);
  const auto description = json::experience_line_from_json(exported[0]).value_or_throw();
  EXPECT_EQ(std::get<RobotDescription>(description).urdf, large.urdf);
  const auto line = json::experience_line_from_json(exported[1]).value_or_throw();
  EXPECT_EQ(std::get<json::NamedAttempt>(line).attempt.path->waypoints(), waypoints);
}

TEST_F(Administrators, WhatWasRetiredIsNeverServedAgainAlsoIfTheServerDiesAtOnce) {
  const Digest panda = cell_.register_model("panda").robot;
  const Digest ur10e = cell_.register_model("ur10e").robot;
  const std::string gone = cell_.report(panda, 0, 6).at(0).text();
  const FetchReply before = cell_.fetch(ur10e);
  ASSERT_EQ(before.status, FetchStatus::Ready) << before.message;
  const AdminReply retired = cell_.ask(AdminVerb::RetirePath, gone);
  ASSERT_EQ(retired.status, AdminStatus::Ok) << retired.message;
  cell_.kill();
  cell_.start();
  const FetchReply after = cell_.fetch(ur10e);
  ASSERT_EQ(after.status, FetchStatus::Ready) << after.message;
  EXPECT_GT(after.distribution->revision, before.distribution->revision);
  EXPECT_EQ(after.distribution->sources.at(0).paths, 5U);
  const std::vector<std::string> exported = rows(AdminVerb::ExportPaths, "", "sweep");
  EXPECT_EQ(exported.size(), 6U);  // the robot, and five attempts
  for (const std::string& line : exported)
    EXPECT_EQ(line.find(gone), std::string::npos);
}

TEST(AdministratorsWithAToken, AreHeardByAServerThatWasStartedAnew) {
  const test::TemporaryDirectory directory;
  const test::ReservedDomain domain;
  const std::filesystem::path token = directory / "token";
  const std::string configuration =
      dds::cyclone_configuration({.domain = domain.number(), .role = dds::Role::Server});
  std::optional<test::ServerProcess> server;
  const auto start = [&] {
    // As the configuration that is built in, but a server that is given one asks for its token.
    setenv("CYCLONEDDS_URI", configuration.c_str(), 1);
    server.emplace(
        test::ServerProcess::Options{.store = directory / "fleet.db",
                                     .domain = domain.number(),
                                     .arguments = {"--insecure", "--token-file", token.string()}});
    unsetenv("CYCLONEDDS_URI");
  };
  const AdminRequest change{.verb = AdminVerb::RenameRobot, .argument = "other", .robot = "none"};
  start();
  link::Client stranger({.domain = domain.number(), .token = {}, .has_outbox = false});
  EXPECT_EQ(stranger.admin(change).value_or_throw().status, AdminStatus::Refused);
  link::Client client({.domain = domain.number(), .token = token, .has_outbox = false});
  const AdminReply before = client.admin(change).value_or_throw();
  EXPECT_EQ(before.status, AdminStatus::NotFound) << before.message;
  server->kill();
  start();
  const AdminReply after = client.admin(change).value_or_throw();
  EXPECT_EQ(after.status, AdminStatus::NotFound) << after.message;
}

}  // namespace
}  // namespace kinship::administration_test
