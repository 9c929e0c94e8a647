#include "server/app/access_gate.hpp"

#include <latch>

#include "server/access/withheld_sources.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::app::access_gate_test {
namespace {

/// The gate before a real service, with a caller of role robot.
class AccessGate : public service::ServiceFixture {
 protected:
  AccessGate() {
    may_trouble_store_ = true;
    start();
    for (const RobotSummary& robot : real_store_->list_robots("", 100).rows)
      (robot.label == "teacher" ? teacher_
       : robot.label == "pupil" ? pupil_
                                : dwarf_) = registry_->find(robot.robot).value_or_throw();
    caller_ = {"robot_7", "robot_7", AccessRole::Robot, {}, {}, false};
  }
  ReportReply report(std::vector<Attempt> attempts) {
    std::promise<ReportReply> reply;
    app::report(service_->reports(), service_->registration(), caller_, {std::move(attempts), {}},
                [&](const ReportReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }
  RegisterReply register_robot(const RobotDescription& description) {
    std::promise<RegisterReply> reply;
    app::register_robot(service_->registration(), caller_, description,
                        [&](const RegisterReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }
  FetchReply fetch(const runtime::Robot& robot, const std::string& task) {
    FetchRequest request = request_for(robot);
    request.task = task;
    request.experience_bytes = experience_bytes_;
    std::promise<FetchReply> reply;
    app::fetch(service_->fetches(), service_->registration(), caller_, request, "one",
               [&](const FetchReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }
  static const Receipt& of(const ReportReply& reply, const Attempt& attempt) {
    for (const Receipt& receipt : reply.receipts)
      if (receipt.report_uuid == attempt.report_uuid)
        return receipt;
    throw std::runtime_error("no receipt");
  }

  runtime::RobotRegistry::RobotPointer teacher_, pupil_, dwarf_;
  Caller caller_;
  std::uint32_t experience_bytes_ = 0;  // that fetches ask for
};

TEST_F(AccessGate, TheNameInTheCertificateIsTheMachine) {
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  ASSERT_NE(attempt.machine, "robot_7");
  EXPECT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::Stored);
  EXPECT_EQ(real_store_->find_attempt(attempt.report_uuid)->machine, "robot_7");
  EXPECT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::Duplicate);
  caller_.name.clear();  // the same without security
  const Attempt free = fleet::solved(*teacher_, "shelf", 2);
  EXPECT_EQ(of(report({free}), free).status, ReceiptStatus::Stored);
  EXPECT_EQ(real_store_->find_attempt(free.report_uuid)->machine, free.machine);
}

TEST_F(AccessGate, AReportOfBeforeThereWereCertificatesIsStillADuplicate) {
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  ASSERT_EQ(ServiceFixture::report({attempt}).receipts.at(0).status, ReceiptStatus::Stored);
  EXPECT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::Duplicate);
  caller_.name = "robot_8";
  EXPECT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::Duplicate);
  Attempt other = attempt;
  other.record.planning_time_s += 1;
  EXPECT_EQ(of(report({other}), other).status, ReceiptStatus::Refused);
}

TEST_F(AccessGate, AnAttemptThatIsNotItsToReportIsRefusedAlone) {
  caller_.tasks = {"shelf"};
  caller_.robots = {"teacher"};
  const std::vector<Attempt> attempts = {
      fleet::solved(*teacher_, "shelf", 1), fleet::solved(*teacher_, "bin", 2),
      fleet::solved(*pupil_, "shelf", 3), fleet::unsolved(Digest(), "shelf")};
  const ReportReply reply = report(attempts);
  EXPECT_EQ(of(reply, attempts[0]).status, ReceiptStatus::Stored);
  EXPECT_EQ(of(reply, attempts[1]).status, ReceiptStatus::Refused);
  EXPECT_EQ(of(reply, attempts[1]).message,
            "robot_7 (role robot) may not report for task 'bin': its certificate is for tasks "
            "shelf, robots teacher");
  EXPECT_EQ(of(reply, attempts[2]).status, ReceiptStatus::Refused);
  EXPECT_EQ(of(reply, attempts[3]).status, ReceiptStatus::UnknownRobot);
  EXPECT_FALSE(real_store_->find_attempt(attempts[1].report_uuid));
  EXPECT_FALSE(real_store_->find_attempt(attempts[2].report_uuid));
  EXPECT_TRUE(is_told("may not report for task 'bin'"));
}

TEST_F(AccessGate, ARobotThatCannotBeReadNowIsTriedAgain) {
  caller_.robots = {"teacher"};
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  adjust_ = [](service::ServiceOptions& options) { options.max_robots = 1; };
  start();  // another robot is in memory
  store::damage_robot(directory_ / "fleet.db", "teacher");
  EXPECT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::TryAgain);
}

TEST_F(AccessGate, ARobotRegistersUnderTheLabelsOfItsCertificate) {
  caller_.robots = {"cell_*"};
  const RegisterReply refused = register_robot(fleet::planar("other", {0.4, 0.3, 0.2, 0.15}));
  EXPECT_EQ(refused.status, RegisterStatus::Refused);
  EXPECT_EQ(refused.message,
            "robot_7 (role robot) may not register robot 'other': its certificate is for robots "
            "cell_*");
  EXPECT_EQ(register_robot(fleet::planar("cell_1", {0.4, 0.3, 0.2, 0.15})).status,
            RegisterStatus::Registered);
}

/// Collision geometry that a robot of `planar` may have, without being another robot.
RobotDescription with_exact_shapes(RobotDescription description) {
  const std::string plain = "<link name='link1'/>";
  description.urdf.replace(
      description.urdf.find(plain), plain.size(),
      "<link name='link1'><collision><geometry><sphere radius='0.05'/></geometry></collision>"
      "</link>");
  return description;
}

TEST_F(AccessGate, ARobotThatIsKnownUnderAnothersLabelIsNotTaken) {
  caller_.robots = {"cell_*"};
  RobotDescription same = with_exact_shapes(fleet::teacher());
  same.label = "cell_1";
  const RegisterReply reply = register_robot(same);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_EQ(reply.message,
            "robot_7 (role robot) may not register this robot: it is known here under another "
            "label, and its certificate is for robots cell_*");
  EXPECT_FALSE(reply.took_geometry);
  EXPECT_TRUE(reply.same_arms.empty());
  EXPECT_EQ(real_store_->find_robot(teacher_->digest)->geometry_revision, 0U);
  // Nor if its row cannot be read: it would be written anew.
  adjust_ = [](service::ServiceOptions& options) { options.max_robots = 1; };
  start();  // another robot is in memory
  store::damage_robot(directory_ / "fleet.db", "teacher");
  EXPECT_EQ(register_robot(same).status, RegisterStatus::Refused);
  // By its own label it is taken.
  caller_.robots = {"pup*"};
  same = with_exact_shapes(fleet::pupil());
  EXPECT_TRUE(register_robot(same).took_geometry);
  EXPECT_EQ(real_store_->find_robot(pupil_->digest)->geometry_revision, 1U);
}

TEST_F(AccessGate, AFetchForARobotThatCannotBeReadNowIsPutOff) {
  adjust_ = [](service::ServiceOptions& options) { options.max_robots = 1; };
  start();
  report({fleet::solved(*teacher_, "shelf", 1)});
  ASSERT_EQ(fetch(*teacher_, "shelf").status, FetchStatus::Ready);
  ServiceFixture::register_robot(fleet::pupil());  // now this one is in memory
  store::damage_robot(directory_ / "fleet.db", "teacher");
  ASSERT_EQ(fetch(*teacher_, "shelf").status, FetchStatus::Ready) << "the distribution is there";
  caller_.robots = {"pupil"};
  const FetchReply reply = fetch(*teacher_, "shelf");
  EXPECT_EQ(reply.status, FetchStatus::Busy);
  EXPECT_GT(reply.retry_after.count(), 0);
  EXPECT_FALSE(reply.distribution);
  EXPECT_EQ(reply.message.find("teacher"), std::string::npos) << reply.message;
}

TEST_F(AccessGate, WhoFindsNoRoomForItsRobotsNamesIsToldWhenToComeAgain) {
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  adjust_ = [](service::ServiceOptions& options) {
    options.max_robots = 1;  // names are looked up in the store
    options.client_short_tasks = 1;
  };
  start();
  caller_.robots = {"teacher"};
  std::latch may_go_on(1);
  std::promise<void> begun;
  service_->administration().administer(
      fleet::question(AdminVerb::ListTasks), "other 1",
      [&](const service::AdminPage&) {
        begun.set_value();
        may_go_on.wait();
      },
      fleet::caller_here());
  begun.get_future().wait();
  std::promise<FetchReply> first;
  app::fetch(service_->fetches(), service_->registration(), caller_, request_for(*teacher_), "one",
             [&](const FetchReply& reply) { first.set_value(reply); });
  const ReportReply reply = report({attempt});
  EXPECT_EQ(of(reply, attempt).status, ReceiptStatus::TryAgain);
  EXPECT_GT(reply.retry_after.count(), 0);
  const FetchReply fetched = fetch(*teacher_, "shelf");
  EXPECT_EQ(fetched.status, FetchStatus::Busy);
  EXPECT_GT(fetched.retry_after.count(), 0);
  may_go_on.count_down();
  first.get_future().wait();
}

TEST_F(AccessGate, FetchesAreForItsTasksAndRobots) {
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  report({attempt});
  caller_.tasks = {"shelf"};
  caller_.robots = {"teacher"};
  EXPECT_EQ(fetch(*teacher_, "shelf").status, FetchStatus::Ready);
  const FetchReply task = fetch(*teacher_, "bin");
  EXPECT_EQ(task.status, FetchStatus::Refused);
  EXPECT_EQ(task.message,
            "robot_7 (role robot) may not fetch for task 'bin': its certificate is "
            "for tasks shelf, robots teacher");
  EXPECT_EQ(fetch(*pupil_, "shelf").status, FetchStatus::Refused);
}

TEST_F(AccessGate, ANearTaskIsNamedToWhoMayListTasks) {
  const Attempt attempt = fleet::solved(*teacher_, "shelf", 1);
  ASSERT_EQ(of(report({attempt}), attempt).status, ReceiptStatus::Stored);
  EXPECT_EQ(fetch(*teacher_, "shelv").message, "no paths of task 'shelv'");
  caller_.role = AccessRole::Reader;
  EXPECT_EQ(fetch(*teacher_, "shelv").message, "no paths of task 'shelv' (did you mean 'shelf'?)");
  caller_.tasks = {"sh*"};
  EXPECT_EQ(fetch(*teacher_, "shelv").message, "no paths of task 'shelv'");
}

TEST_F(AccessGate, AFetchForSomeRobotsDoesNotSayWhichOthersItIsMadeOf) {
  report({fleet::solved(*teacher_, "shelf", 1), fleet::solved(*pupil_, "shelf", 2)});
  experience_bytes_ = kDefaultExperienceBytes;
  const FetchReply open = fetch(*pupil_, "shelf");
  ASSERT_EQ(open.status, FetchStatus::Ready) << open.message;
  ASSERT_EQ(open.distribution->sources.size(), 2U);
  ASSERT_TRUE(open.experience);
  caller_.robots = {"pup*"};
  const FetchReply reply = fetch(*pupil_, "shelf");
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->id, open.distribution->id);
  ASSERT_EQ(reply.distribution->sources.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Source& told = reply.distribution->sources[i];
    const Source& known = open.distribution->sources[i];
    const bool is_own = known.label == "pupil";
    EXPECT_EQ(told.label, is_own ? "pupil" : access::kOtherRobot);
    EXPECT_EQ(told.robot, is_own ? pupil_->digest : Digest());
    EXPECT_EQ(told.paths_used, known.paths_used);
  }
  ASSERT_TRUE(reply.experience);
  ASSERT_EQ(reply.experience->paths.size(), open.experience->paths.size());
  for (const PosePath& path : reply.experience->paths)
    EXPECT_TRUE(path.source == pupil_->digest || path.source == Digest());
  // Who asks next, without being narrowed, is told again: replies are shared.
  caller_.robots = {};
  EXPECT_EQ(fetch(*pupil_, "shelf").distribution->sources[0].label,
            open.distribution->sources[0].label);
}

}  // namespace
}  // namespace kinship::app::access_gate_test
