#include "server/fitting/target_memory.hpp"

#include <gtest/gtest.h>

#include "tests/support/robots.hpp"

namespace kinship::fitting::target_memory_test {
namespace {

runtime::Robot robot_of(const std::string& model) {
  kinematics::Chain chain = test::model_chain(model);
  const Digest digest = chain.digest();
  return {digest, model, std::move(chain)};
}

TEST(TargetMemory, PreparesARobotOnce) {
  TargetMemory memory;
  const runtime::Robot panda = robot_of("panda"), ur10e = robot_of("ur10e");
  const TargetMemory::Target prepared = memory.find(panda);
  EXPECT_EQ(prepared->arm->chain().digest(), panda.digest);
  EXPECT_EQ(memory.find(panda), prepared);
  EXPECT_NE(memory.find(ur10e), prepared);
  EXPECT_EQ(memory.find(panda), prepared);
}

TEST(TargetMemory, BetterGeometryIsTakenOver) {
  TargetMemory memory;
  runtime::Robot robot = robot_of("ur10e");
  EXPECT_TRUE(memory.find(robot)->solids.parts().bodies.empty());
  robot.shapes =
      geometry::read_shapes(test::model_description("ur10e"), robot.chain).value_or_throw();
  ++robot.geometry_revision;
  const TargetMemory::Target better = memory.find(robot);
  EXPECT_FALSE(better->solids.parts().bodies.empty());
  EXPECT_EQ(memory.find(robot), better);
  EXPECT_EQ(memory.size(), 1U);
}

TEST(TargetMemory, TheOneNotUsedForLongestGoesFirst) {
  TargetMemory memory(2);
  const runtime::Robot panda = robot_of("panda"), ur10e = robot_of("ur10e"),
                       iiwa14 = robot_of("iiwa14");
  const TargetMemory::Target first = memory.find(panda), second = memory.find(ur10e);
  memory.find(panda);
  memory.find(iiwa14);
  EXPECT_EQ(memory.size(), 2U);
  EXPECT_EQ(memory.find(panda), first);
  EXPECT_NE(memory.find(ur10e), second);
}

}  // namespace
}  // namespace kinship::fitting::target_memory_test
