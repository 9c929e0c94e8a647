#include "server/fitting/fit_memory.hpp"

#include <gtest/gtest.h>

#include "server/fitting/target_memory.hpp"
#include "tests/support/robots.hpp"

namespace kinship::fitting::memories_test {
namespace {

Digest id_of(int number) {
  Digest id;
  id.bytes[0] = static_cast<std::uint8_t>(number);
  return id;
}

/// One path with so many configurations of two joints.
FitMemory::State warm_state(Eigen::Index configurations) {
  auto path = std::make_shared<transfer::TransferredPath>();
  path->configurations = Eigen::MatrixXd::Zero(2, configurations);
  WarmState warm_state;
  warm_state.paths[1].path = path;
  return std::make_shared<const WarmState>(warm_state);
}

TEST(FitMemory, DropsWhatWasNotUsedForLongest) {
  const FitMemory::State some = warm_state(1000);
  FitMemory memory(3 * size_of(some->paths));
  for (const int i : {1, 2, 3})
    memory.put(id_of(i), some);
  EXPECT_EQ(memory.find(id_of(1)), some);  // 2 is now the oldest
  memory.put(id_of(4), some);
  EXPECT_EQ(memory.find(id_of(2)), nullptr);
  for (const int i : {1, 3, 4})
    EXPECT_NE(memory.find(id_of(i)), nullptr) << i;
  EXPECT_EQ(memory.bytes(), 3 * size_of(some->paths));
}

TEST(FitMemory, ReplacesAndForgets) {
  FitMemory memory;
  memory.put(id_of(1), warm_state(10));
  const FitMemory::State more = warm_state(1000);
  memory.put(id_of(1), more);
  EXPECT_EQ(memory.find(id_of(1)), more);
  EXPECT_EQ(memory.bytes(), size_of(more->paths));
  memory.erase(id_of(1));
  memory.erase(id_of(1));
  EXPECT_EQ(memory.find(id_of(1)), nullptr);
  EXPECT_EQ(memory.bytes(), 0U);
}

TEST(FitMemory, KeepsNothingThatIsLargerThanAll) {
  const FitMemory::State small = warm_state(10), large = warm_state(100'000);
  FitMemory memory(2 * size_of(small->paths));
  memory.put(id_of(1), small);
  memory.put(id_of(2), small);
  memory.put(id_of(1), large);
  EXPECT_EQ(memory.find(id_of(1)), nullptr);  // what it replaces is outdated
  EXPECT_EQ(memory.find(id_of(2)), small);
}

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
  robot.shapes = geometry::read_shapes(test::robot_model("ur10e")).value_or_throw();
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
}  // namespace kinship::fitting::memories_test
