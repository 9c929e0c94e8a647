// Robots that get another label or are taken out, on a whole service.

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::robot_upkeep_test {
namespace {

class RobotUpkeep : public ServiceFixture {
 protected:
  AdminPage rename(const std::string& robot, const std::string& label) {
    AdminRequest request = fleet::question(AdminVerb::RenameRobot, label);
    request.robot = robot;
    return administer(request);
  }
  RobotRemoval remove(const std::string& robot) {
    const AdminPage page = administer(fleet::question(AdminVerb::RemoveRobot, robot));
    if (page.status != AdminStatus::Ok)
      throw std::runtime_error(page.message);
    return std::get<RobotRemoval>(page.rows.at(0));
  }
  void teach(int paths) { report(fleet::solved(teacher_, "shelf", paths, 1)); }
};

TEST_F(RobotUpkeep, ARenamedRobotIsFoundByItsNewLabelAlone) {
  teach(2);
  const AdminPage page = rename("teacher", "master");
  ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
  EXPECT_EQ(std::get<RobotSummary>(page.rows[0]).label, "master");
  EXPECT_EQ(std::get<RobotSummary>(page.rows[0]).robot, teacher_.digest);
  EXPECT_EQ(administer(fleet::question(AdminVerb::ShowRobot, "master")).status, AdminStatus::Ok);
  EXPECT_EQ(administer(fleet::question(AdminVerb::ShowRobot, "teacher")).status,
            AdminStatus::NotFound);
  EXPECT_EQ(rename("teacher", "other").status, AdminStatus::NotFound);
  EXPECT_EQ(rename("master", "pupil").status, AdminStatus::Refused);
  EXPECT_EQ(rename("master", "no label").status, AdminStatus::Refused);
  EXPECT_TRUE(is_told("robot 'teacher' (" + teacher_.digest.short_hex() + ") is called 'master'"));
}

TEST_F(RobotUpkeep, ARobotWithoutAttemptsIsDeleted) {
  teach(6);
  ASSERT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  const RobotRemoval removal = remove("pupil");
  EXPECT_TRUE(removal.is_deleted);
  EXPECT_EQ(removal.distributions, 1U);
  const FetchReply reply = fetch(request_for(pupil_));
  EXPECT_EQ(reply.status, FetchStatus::UnknownRobot) << reply.message;
  EXPECT_EQ(register_robot(fleet::pupil()).status, RegisterStatus::Registered);
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
}

TEST_F(RobotUpkeep, WhatWasMadeOfARemovedRobotIsNotServed) {
  teach(6);
  report(fleet::solved(dwarf_, "shelf", 6, 1));
  const FetchReply before = fetch(request_for(pupil_));
  ASSERT_EQ(before.status, FetchStatus::Ready) << before.message;
  ASSERT_EQ(before.distribution->sources.size(), 2U);
  const RobotRemoval removal = remove("teacher");
  EXPECT_EQ(removal.paths, 6U);
  EXPECT_FALSE(removal.is_deleted);
  const FetchReply after = fetch(request_for(pupil_));
  ASSERT_TRUE(after.distribution) << after.message;
  EXPECT_GT(after.distribution->revision, before.distribution->revision);
  std::map<Digest, std::uint64_t> paths;
  for (const Source& source : after.distribution->sources)
    if (source.paths > 0)
      paths[source.robot] += source.paths;
  EXPECT_EQ(paths, (std::map<Digest, std::uint64_t>{{dwarf_.digest, 6}}));
}

TEST_F(RobotUpkeep, WhatTheStoreMadeRoomOfIsNotServedForARemovedRobotEither) {
  may_trouble_store_ = true;
  start();
  teach(6);
  const FetchReply before = fetch(request_for(pupil_));
  ASSERT_EQ(before.status, FetchStatus::Ready) << before.message;
  ASSERT_TRUE(real_store_->evict_distribution(before.distribution->id));
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready) << "it is in memory";
  EXPECT_EQ(remove("pupil").distributions, 0U);
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::UnknownRobot);
}

TEST_F(RobotUpkeep, AFitForARobotThatIsRemovedMeanwhileIsNotServed) {
  teach(6);
  gate_.close();
  auto waiting = begin_fetch(request_for(pupil_), "one");
  gate_.wait_for_calls(1);
  EXPECT_TRUE(remove("pupil").is_deleted);
  gate_.open();
  EXPECT_NE(waiting.get().status, FetchStatus::Ready);
  advance(std::chrono::minutes(5));
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::UnknownRobot);
}

TEST_F(RobotUpkeep, WhoFollowsADistributionOfARemovedRobotFollowsNothingMore) {
  teach(6);
  FetchRequest request = request_for(pupil_);
  request.follow = std::chrono::seconds(3600);
  ASSERT_EQ(fetch(request).status, FetchStatus::Ready);
  ASSERT_EQ(service_->status().followed, 1U);
  remove("pupil");
  const auto next = service_->next_deadline();
  ASSERT_TRUE(next);
  advance(std::chrono::ceil<std::chrono::milliseconds>(
      std::max(*next - clock_.now(), std::chrono::steady_clock::duration())));
  service_->expire(clock_.now());
  administer(fleet::question(AdminVerb::ListTasks));  // behind the look-up
  EXPECT_EQ(service_->status().followed, 0U);
}

TEST_F(RobotUpkeep, ALabelInUseIsRefusedWithWhatToDo) {
  RobotDescription corrected = fleet::teacher();
  corrected.T_tip_transfer.translation().z() += 0.1;
  const RegisterReply reply = register_robot(corrected);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_NE(reply.message.find("kinship robots rename teacher NEW"), std::string::npos)
      << reply.message;
  rename("teacher", "teacher_old");
  EXPECT_EQ(register_robot(corrected).status, RegisterStatus::Registered);
}

}  // namespace
}  // namespace kinship::service::robot_upkeep_test
