#include "server/runtime/robot_registry.hpp"

#include <gtest/gtest.h>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::runtime::robot_registry_test {
namespace {

class Registry : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  RobotRegistry registry_{*store_};
};

TEST_F(Registry, ANewRobotIsIdentifiedStoredAndKept) {
  const RegisterReply reply = registry_.register_robot(fleet::teacher(), 1234);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_EQ(reply.robot, fleet::chain_of(fleet::teacher()).digest());
  EXPECT_EQ(reply.dof, 3U);
  EXPECT_FALSE(reply.solver.empty());
  ASSERT_NE(registry_.find_in_memory(reply.robot), nullptr);
  const auto record = store_->find_robot(reply.robot);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->registered_ms, 1234);
}

TEST_F(Registry, TheSameRobotIsKnownByItsFirstLabel) {
  registry_.register_robot(fleet::teacher(), 1);
  RobotDescription again = fleet::teacher();
  EXPECT_EQ(registry_.register_robot(again, 2).status, RegisterStatus::Known);
  again.label = "other";
  const RegisterReply reply = registry_.register_robot(again, 3);
  EXPECT_EQ(reply.status, RegisterStatus::Known);
  EXPECT_EQ(reply.message, "known already, as 'teacher'");
}

TEST_F(Registry, ALabelBelongsToOneRobot) {
  registry_.register_robot(fleet::teacher(), 1);
  RobotDescription other = fleet::pupil();
  other.label = "teacher";
  const RegisterReply reply = registry_.register_robot(other, 2);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_NE(reply.message.find("teacher"), std::string::npos) << reply.message;
}

TEST_F(Registry, BadDescriptionsAreRefusedWithTheReason) {
  RobotDescription description = fleet::teacher();
  description.label = "two words";
  EXPECT_EQ(registry_.register_robot(description, 1).message,
            "label: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  description = fleet::teacher();
  description.tip_link = "hand";
  const RegisterReply reply = registry_.register_robot(description, 1);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_EQ(reply.message, "tip link 'hand': not in the URDF");
  EXPECT_TRUE(store_->robots().empty());
}

TEST_F(Registry, RobotsOfTheStoreAreReadWhenAskedFor) {
  const Digest robot = RobotRegistry(*store_).register_robot(fleet::teacher(), 1).robot;
  EXPECT_EQ(registry_.find_in_memory(robot), nullptr);
  const auto found = registry_.find(robot);
  ASSERT_TRUE(found);
  EXPECT_EQ(found.value()->label, "teacher");
  EXPECT_EQ(registry_.find_in_memory(robot), found.value());
}

using Labels = std::vector<std::string>;

TEST_F(Registry, TellsWhichKnownRobotsAreTheSameArm) {
  EXPECT_EQ(registry_.register_robot(fleet::teacher(), 1).same_arms, Labels{});
  EXPECT_EQ(registry_.register_robot(fleet::pupil(), 2).same_arms, Labels{});
  EXPECT_EQ(registry_.register_robot(fleet::planar("a_twin", {0.401, 0.3, 0.2}), 3).same_arms,
            Labels{"teacher"});
  EXPECT_EQ(registry_.register_robot(fleet::planar("z_other", {0.45, 0.3, 0.2}), 4).same_arms,
            Labels{});
  const RegisterReply again = registry_.register_robot(fleet::teacher(), 5);
  EXPECT_EQ(again.status, RegisterStatus::Known);
  EXPECT_EQ(again.same_arms, Labels{"a_twin"});
}

TEST_F(Registry, TellsOfRobotsThatARunBeforeThisOneRegistered) {
  RobotRegistry(*store_).register_robot(fleet::teacher(), 1);
  EXPECT_EQ(registry_.register_robot(fleet::planar("twin", {0.401, 0.3, 0.2}), 2).same_arms,
            Labels{"teacher"});
}

TEST_F(Registry, ADamagedRobotIsLeftOutOfTheSameArms) {
  RobotRegistry before(*store_);
  before.register_robot(fleet::teacher(), 1);
  before.register_robot(fleet::planar("second", {0.401, 0.3, 0.2}), 2);
  store::damage_robot(directory_ / "fleet.db", "teacher");
  const RegisterReply reply =
      registry_.register_robot(fleet::planar("third", {0.402, 0.3, 0.2}), 3);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_EQ(reply.same_arms, Labels{"second"});
}

TEST_F(Registry, CollisionMeshesThatItCannotReadDoNotKeepARobotOut) {
  RobotDescription description = fleet::teacher();
  const std::string link = "<link name='link1'/>";
  const std::string mesh =
      "<link name='link1'><collision><geometry><mesh filename='package://nowhere/l1.stl'/>"
      "</geometry></collision></link>";
  description.urdf.replace(description.urdf.find(link), link.size(), mesh);
  EXPECT_EQ(registry_.register_robot(description, 1).status, RegisterStatus::Registered);
}

TEST_F(Registry, UnknownRobotsAreNotFound) {
  const auto found = registry_.find(Digest{});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::NotFound);
  EXPECT_EQ(found.error().message, "robot 000000000000 is not known here; register it first");
}

TEST_F(Registry, ADescriptionThatReadsAsAnotherRobotIsNotUsed) {
  const Digest wrong = fleet::chain_of(fleet::pupil()).digest();
  ASSERT_TRUE(store_->register_robot(
      {.digest = wrong, .description = fleet::teacher(), .dof = 3, .registered_ms = 1}));
  const auto found = registry_.find(wrong);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::Storage) << "nobody's report is refused for it";
}

TEST_F(Registry, KeepsThoseThatWereUsedLast) {
  std::vector<std::string> unreadable;
  RobotRegistry registry(*store_, {.max_robots = 2, .on_unreadable = [&](const std::string& why) {
                                     unreadable.push_back(why);
                                   }});
  std::vector<Digest> robots;
  for (const char* const label : {"a", "b", "c"})
    robots.push_back(
        registry.register_robot(fleet::planar(label, {0.1 * (label[0] - 'a' + 1), 0.3}), 1).robot);
  EXPECT_EQ(registry.in_memory(), 2U);
  EXPECT_EQ(registry.find_in_memory(robots[0]), nullptr);
  EXPECT_TRUE(registry.find(robots[0])) << "it is read again";
  EXPECT_EQ(registry.find_in_memory(robots[1]), nullptr) << "it was not used for longest";
  EXPECT_NE(registry.find_in_memory(robots[2]), nullptr);
  EXPECT_TRUE(unreadable.empty());
  store::damage_robot(directory_ / "fleet.db", "b");
  EXPECT_FALSE(registry.find(robots[1]));
  EXPECT_EQ(unreadable.size(), 1U);
}

TEST_F(Registry, ADamagedRobotIsAnErrorOfTheStoreAndNoException) {
  const Digest robot = RobotRegistry(*store_).register_robot(fleet::teacher(), 1).robot;
  store::damage_robot(directory_ / "fleet.db", "teacher");
  const auto found = registry_.find(robot);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::Storage);
}

}  // namespace
}  // namespace kinship::runtime::robot_registry_test
