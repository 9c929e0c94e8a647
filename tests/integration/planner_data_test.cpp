// OMPL's planner data as a source of experience: a roadmap that OMPL itself grew and stored.

#include <gtest/gtest.h>
#include <ompl/base/PlannerDataStorage.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <string>

#include "tests/support/cell.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::planner_data_test {
namespace {

namespace ob = ompl::base;

/// Stores the trees of a query around a wall in the middle of the first joint's range.
void store_trees(const std::filesystem::path& file) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(20261129);
  const auto space = std::make_shared<ob::RealVectorStateSpace>(6);
  space->setBounds(-1.5, 1.5);
  ompl::geometric::SimpleSetup setup(space);
  setup.setStateValidityChecker([](const ob::State* state) {
    const double* q = state->as<ob::RealVectorStateSpace::StateType>()->values;
    return std::abs(q[0]) > 0.1 || q[1] > 0.5;
  });
  ob::ScopedState<ob::RealVectorStateSpace> start(space), goal(space);
  start = std::vector<double>{-1, -0.5, 0.5, 0, 0.3, 0};
  goal = std::vector<double>{1, -0.5, 0.5, 0, 0.3, 0};
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.getSpaceInformation()));
  ASSERT_TRUE(setup.solve(20.0));
  ob::PlannerData data(setup.getSpaceInformation());
  setup.getPlannerData(data);
  ob::PlannerDataStorage().store(data, file.c_str());
}

TEST(PlannerData, BecomesThePathThatItHolds) {
  const test::TemporaryDirectory folder;
  test::Cell cell({.folder = folder.path()});
  cell.start();
  ASSERT_EQ(cell.kinship("robots register " + test::source_dir() + "/robots/models/ur10e").code, 0);
  const std::string file = folder / "trees";
  store_trees(file);
  const std::string command = "paths import --ompl-planner-data " + file + " --robot ur10e";

  EXPECT_EQ(cell.kinship(command).code, 2) << "without a task";
  const test::Answer taken = cell.kinship(command + " --task around");
  EXPECT_EQ(taken.code, 0) << taken.err;
  EXPECT_EQ(taken.out.substr(0, 13), "1 path stored") << taken.out;
  EXPECT_NE(taken.err.find("x vertex that is on no such path"), std::string::npos) << taken.err;
  EXPECT_NE(cell.kinship(command + " --task around").out.find("1 known already"),
            std::string::npos);
  const test::Answer stored = cell.kinship("paths export --task around");
  // The same report from anywhere: version 8, of the content.
  const std::string uuid = stored.out.substr(stored.out.find("\"report_uuid\":\"") + 15, 36);
  EXPECT_EQ(uuid[14], '8') << uuid;
  EXPECT_NE(stored.out.find("\"waypoints\":[[-1.0,-0.5,0.5,0.0,0.3,0.0],"), std::string::npos)
      << stored.out;
  EXPECT_NE(stored.out.find("[1.0,-0.5,0.5,0.0,0.3,0.0]]"), std::string::npos);
}

}  // namespace
}  // namespace kinship::planner_data_test
