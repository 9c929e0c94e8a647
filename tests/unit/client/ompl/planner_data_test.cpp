#include "client/ompl/planner_data.hpp"

#include <gtest/gtest.h>
#include <ompl/base/PlannerDataStorage.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/util/Console.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <numbers>

#include "proto/types/failure.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::ompl_planners::planner_data_test {
namespace {

namespace ob = ompl::base;

/// MoveIt's space of a group as its file shows it: a tag before the values, no known kind.
class GroupSpace : public ob::RealVectorStateSpace {
 public:
  explicit GroupSpace(unsigned int dof) : RealVectorStateSpace(dof) {
    type_ = ob::STATE_SPACE_UNKNOWN;
  }
  unsigned int getSerializationLength() const override {
    return static_cast<unsigned int>(sizeof(int)) + RealVectorStateSpace::getSerializationLength();
  }
  void serialize(void* bytes, const ob::State* state) const override {
    const int tag = -1;
    std::memcpy(bytes, &tag, sizeof tag);
    RealVectorStateSpace::serialize(static_cast<char*>(bytes) + sizeof tag, state);
  }
};

/// A roadmap that OMPL stores: two starts, three goals, a detour, and a part on its own.
class PlannerDataFile : public testing::Test {
 protected:
  using At = std::function<ob::PlannerDataVertex(double, double)>;

  PlannerDataFile() { ompl::msg::noOutputHandler(); }

  std::filesystem::path store(const std::shared_ptr<ob::RealVectorStateSpace>& space) {
    return store(space, [](ob::PlannerData& data, const At& at) {
      const unsigned start = data.addStartVertex(at(0, 0)), middle = data.addVertex(at(1, 0)),
                     detour = data.addVertex(at(1, 2)), goal = data.addGoalVertex(at(2, 0)),
                     other_start = data.addStartVertex(at(0, 1)), away = data.addVertex(at(-2, -2));
      const unsigned far_goal = data.addGoalVertex(at(-2, -1));
      data.addGoalVertex(at(-1, -1));
      data.addEdge(start, detour);
      data.addEdge(detour, goal);
      data.addEdge(start, middle);
      data.addEdge(goal, middle);  // a tree from the goal has its edges the other way
      data.addEdge(other_start, detour);
      data.addEdge(away, far_goal);
    });
  }

  /// From 2 to -2 rad of the first joint over 0, and over pi with the second joint at 1 rad, which
  /// is longer where the first joint does not turn on: 4 against 2 sqrt 2 + 0.28.
  std::filesystem::path store_past_pi(const std::shared_ptr<ob::RealVectorStateSpace>& space) {
    return store(space, [](ob::PlannerData& data, const At& at) {
      const unsigned start = data.addStartVertex(at(2, 0)), before = data.addVertex(at(3, 1)),
                     after = data.addVertex(at(-3, 1)), goal = data.addGoalVertex(at(-2, 0));
      data.addEdge(start, before);
      data.addEdge(before, after);
      data.addEdge(after, goal);
      const unsigned between = data.addVertex(at(0, 0));
      data.addEdge(start, between);
      data.addEdge(between, goal);
    });
  }

  std::string complaint(const std::filesystem::path& file) {
    try {
      read_planner_data(file, arm_);
      return "";
    } catch (const Failure& failure) {
      return failure.what();
    }
  }

 private:
  std::filesystem::path store(const std::shared_ptr<ob::RealVectorStateSpace>& space,
                              const std::function<void(ob::PlannerData&, const At&)>& fill) {
    ob::RealVectorBounds bounds(space->getDimension());
    bounds.setLow(-3);
    bounds.setHigh(3);
    space->setBounds(bounds);
    const auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker([](const ob::State*) { return true; });
    information->setup();
    ob::PlannerData data(information);
    std::vector<ob::State*> states;
    fill(data, [&](double x, double y) {
      states.push_back(space->allocState());
      double* values = states.back()->as<ob::RealVectorStateSpace::StateType>()->values;
      std::fill_n(values, space->getDimension(), 0.0);
      values[0] = x;
      values[1] = y;
      return ob::PlannerDataVertex(states.back());
    });
    const std::filesystem::path file = folder_ / "roadmap";
    ob::PlannerDataStorage().store(data, file.c_str());
    for (ob::State* state : states)
      space->freeState(state);
    return file;
  }

 protected:
  test::TemporaryDirectory folder_;
  kinematics::Chain arm_ = test::PlanarArm{{0.5, 0.4, 0.3}}.chain();
};

void expect_ways(const RoadmapPaths& found) {
  ASSERT_EQ(found.paths.size(), 2U);
  Eigen::MatrixXd direct = Eigen::MatrixXd::Zero(3, 3), bent = direct;
  direct.topRows(2) << 0, 1, 2, 0, 0, 0;
  bent.topRows(2) << 0, 1, 2, 1, 2, 0;
  EXPECT_EQ(found.paths[0].waypoints(), direct);
  EXPECT_EQ(found.paths[1].waypoints(), bent);
  EXPECT_EQ(found.without_way, 2U);
  EXPECT_EQ(found.other_vertices, 3U);
}

TEST_F(PlannerDataFile, HasTheShortestWaysFromStartsToGoals) {
  expect_ways(read_planner_data(store(std::make_shared<ob::RealVectorStateSpace>(3)), arm_));
}

TEST_F(PlannerDataFile, OfMoveItIsReadToo) {
  expect_ways(read_planner_data(store(std::make_shared<GroupSpace>(3)), arm_));
}

TEST_F(PlannerDataFile, ContinuousJointsGoTheShorterWayInMoveItsSpaceAlone) {
  arm_ = test::PlanarArm{.lengths_m = {0.5, 0.4, 0.3}, .type = kinematics::JointType::Continuous}
             .chain();
  const auto path_in = [&](const std::shared_ptr<ob::RealVectorStateSpace>& space) {
    return read_planner_data(store_past_pi(space), arm_).paths.at(0).waypoints();
  };
  Eigen::MatrixXd expected(3, 4);
  expected << 2, 3, 2 * std::numbers::pi - 3, 2 * std::numbers::pi - 2, 0, 1, 1, 0, 0, 0, 0, 0;
  EXPECT_TRUE(path_in(std::make_shared<GroupSpace>(3)).isApprox(expected, 1e-12))
      << path_in(std::make_shared<GroupSpace>(3));
  expected.resize(3, 3);
  expected << 2, 0, -2, 0, 0, 0, 0, 0, 0;
  EXPECT_EQ(path_in(std::make_shared<ob::RealVectorStateSpace>(3)), expected);
  arm_ = test::PlanarArm{{0.5, 0.4, 0.3}}.chain();
  EXPECT_EQ(path_in(std::make_shared<GroupSpace>(3)), expected) << "revolute";
}

TEST_F(PlannerDataFile, OfAnotherSpaceIsRefused) {
  EXPECT_NE(
      complaint(store(std::make_shared<ob::RealVectorStateSpace>(2)))
          .find("its states are not 3 real numbers, the robot's joints: the space's signature "
                "is (2 1 2)"),
      std::string::npos);
}

TEST_F(PlannerDataFile, CutOrForeignIsRefusedByName) {
  const std::filesystem::path file = store(std::make_shared<ob::RealVectorStateSpace>(3));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 30);
  EXPECT_NE(complaint(file).find("roadmap': is no planner data of OMPL"), std::string::npos);
  std::ofstream(folder_ / "text") << "no archive";
  EXPECT_NE(complaint(folder_ / "text").find("is no planner data of OMPL"), std::string::npos);
  EXPECT_NE(complaint(folder_ / "none").find("cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace kinship::ompl_planners::planner_data_test
