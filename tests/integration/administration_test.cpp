// What administrators ask of kinshipd, over loopback DDS: long rows, jobs, and what must stay gone.

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <thread>

#include "client/link/admin_rows.hpp"
#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/limits.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::administration_test {
namespace {

using std::chrono::seconds;

class Administrators : public testing::Test {
 protected:
  Administrators() {
    start_server();
    client_ = std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain_.number(), .outbox = directory_ / "outbox", .timeout = seconds(30)});
    panda_ = register_robot(test::model_description("panda"));
    ur10e_ = register_robot(test::model_description("ur10e"));
  }

  void start_server() {
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  }
  Digest register_robot(const RobotDescription& description) {
    const RegisterReply reply = client_->register_robot(description).value_or_throw();
    EXPECT_NE(reply.status, RegisterStatus::Refused) << reply.message;
    return reply.robot;
  }
  /// Durable at the server on return.
  void report(const std::vector<Attempt>& attempts) {
    const std::size_t before = client_->outbox().accepted;
    for (const Attempt& attempt : attempts)
      client_->report(attempt);
    const link::Client::OutboxState outbox = client_->flush(seconds(60));
    ASSERT_EQ(outbox.pending, 0U) << outbox.problem;
    ASSERT_EQ(outbox.accepted, before + attempts.size());
  }
  std::vector<Attempt> panda_attempts(std::uint64_t count) const {
    std::vector<Attempt> attempts;
    for (std::uint64_t i = 0; i < count; ++i)
      attempts.push_back(test::panda_attempt(panda_, "sweep", i));
    return attempts;
  }
  FetchReply fetch() {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e_;
    request.deadline = seconds(60);
    return client_->fetch(request).value_or_throw();
  }
  static AdminRequest question(AdminVerb verb, const std::string& argument) {
    AdminRequest request;
    request.verb = verb;
    request.argument = argument;
    return request;
  }
  AdminReply ask(AdminVerb verb, const std::string& argument) {
    return client_->admin(question(verb, argument)).value_or_throw();
  }
  std::vector<std::string> rows(const AdminRequest& request) {
    return link::rows_of(*client_, request).value_or_throw();
  }
  Job end_of(const AdminRequest& begin) {
    const Job job = link::row_of<Job>(*client_, begin).value_or_throw();
    return link::wait_for_job(*client_, job.id, std::chrono::steady_clock::now() + seconds(60))
        .value_or_throw();
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
  std::unique_ptr<link::Client> client_;
  Digest panda_, ur10e_;
};

TEST_F(Administrators, ALongRobotAndALongPathAreShownAndExportedWhole) {
  RobotDescription large = test::model_description("iiwa14");
  large.label = "large";
  large.urdf.insert(large.urdf.rfind("</robot>"),
                    "<!--" + std::string(kMaxUrdfBytes - large.urdf.size() - 7, 'x') + "-->");
  const Digest robot = register_robot(large);
  Attempt attempt = test::panda_attempt(robot, "long", 1);
  constexpr Eigen::Index kColumns = kMaxBatchBytes / sizeof(double) / 7;
  Eigen::MatrixXd waypoints(7, kColumns);
  for (Eigen::Index i = 0; i < kColumns; ++i)
    waypoints.col(i).setConstant(0.3 * std::sin(static_cast<double>(i)));
  attempt.path = Path(waypoints);
  report({attempt});

  const std::vector<std::string> shown = rows(question(AdminVerb::ShowRobot, "large"));
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(json::robot_description_from_json(shown[1]).value_or_throw().urdf, large.urdf);
  EXPECT_TRUE(ask(AdminVerb::ShowRobot, "large").last_row_continues);

  AdminRequest request = question(AdminVerb::ExportPaths, "");
  request.task = "long";
  const std::vector<std::string> exported = rows(request);
  ASSERT_EQ(exported.size(), 2U);
  const auto description = json::experience_line_from_json(exported[0]).value_or_throw();
  EXPECT_EQ(std::get<RobotDescription>(description).urdf, large.urdf);
  const auto line = json::experience_line_from_json(exported[1]).value_or_throw();
  EXPECT_EQ(std::get<json::NamedAttempt>(line).attempt.path->waypoints(), waypoints);
}

TEST_F(Administrators, ABackupIsMadeWhileReportsGoOn) {
  report(panda_attempts(20));
  std::promise<void> stop;
  std::thread reporter([this, stopped = stop.get_future().share()] {
    for (std::uint64_t i = 100; stopped.wait_for(seconds(0)) != std::future_status::ready; ++i) {
      client_->report(test::panda_attempt(panda_, "sweep", i));
      client_->flush(seconds(60));
    }
  });
  const Job job = end_of(question(AdminVerb::Backup, "copy.db"));
  stop.set_value();
  reporter.join();
  ASSERT_EQ(job.state, JobState::Done) << job.message;
  EXPECT_EQ(ask(AdminVerb::Backup, "copy.db").status, AdminStatus::Refused);

  EXPECT_EQ(server_->terminate(), 0);
  server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
      .store = directory_ / "copy.db", .domain = domain_.number(), .arguments = {}});
  AdminRequest request = question(AdminVerb::ExportPaths, "");
  request.task = "sweep";
  EXPECT_GE(rows(request).size(), 21U);
}

TEST_F(Administrators, WhatWasRetiredIsNeverServedAgainAlsoIfTheServerDiesAtOnce) {
  const std::vector<Attempt> attempts = panda_attempts(6);
  report(attempts);
  const FetchReply before = fetch();
  ASSERT_EQ(before.status, FetchStatus::Ready) << before.message;
  const AdminReply retired = ask(AdminVerb::RetirePath, attempts[0].report_uuid.text());
  ASSERT_EQ(retired.status, AdminStatus::Ok) << retired.message;
  server_->kill();
  start_server();
  const FetchReply after = fetch();
  ASSERT_EQ(after.status, FetchStatus::Ready) << after.message;
  EXPECT_GT(after.distribution->revision, before.distribution->revision);
  EXPECT_EQ(after.distribution->sources.at(0).paths, 5U);
  AdminRequest request = question(AdminVerb::ExportPaths, "");
  request.task = "sweep";
  const std::vector<std::string> exported = rows(request);
  EXPECT_EQ(exported.size(), 6U);  // the robot, and five attempts
  for (const std::string& line : exported)
    EXPECT_EQ(line.find(attempts[0].report_uuid.text()), std::string::npos);
}

}  // namespace
}  // namespace kinship::administration_test
