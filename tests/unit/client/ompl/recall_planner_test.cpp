// Recalled paths in a SimpleSetup of OMPL: a Panda and a shelf that stands elsewhere each time.

#include "client/ompl/recall_planner.hpp"

#include <gtest/gtest.h>
#include <ompl/base/goals/GoalLazySamples.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/util/Console.h>

#include <future>
#include <stdexcept>
#include <utility>
#include <vector>

#include "client/ompl/state_space.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::ompl_planners::recall_planner_test {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using recall::test_support::kStep;
using recall::test_support::made_shelf;

constexpr double kEnough_s = 120;

/// Tried as long as there is a candidate.
std::shared_ptr<const recall::RecallGuide> patient_guide() {
  static const auto guide = [] {
    RecallLibrary library = made_shelf().library;
    library.search_checks = 1e6;
    return std::make_shared<const recall::RecallGuide>(made_shelf().cell.chain, library);
  }();
  return guide;
}

/// No motion is valid.
class NoMotion : public ob::MotionValidator {
 public:
  using ob::MotionValidator::MotionValidator;
  bool checkMotion(const ob::State*, const ob::State*) const override { return false; }
  bool checkMotion(const ob::State*, const ob::State*,
                   std::pair<ob::State*, double>&) const override {
    return false;
  }
};

/// A query that was not recorded, as users of OMPL pose it.
class Asked {
 public:
  explicit Asked(recall::PosedQuery its) : posed(std::move(its)) {
    information()->setStateValidityCheckingResolution(kStep / space_->getMaximumExtent());
    setup.setStateValidityChecker([this](const ob::State* state) {
      return !world.collides(to_configuration(*state, posed.start.size()));
    });
    ob::ScopedState<> state(space_);
    copy_to_state(posed.start, *state.get());
    setup.addStartState(state);
    const auto goals = std::make_shared<ob::GoalStates>(information());
    for (const auto& q : posed.goals.colwise()) {
      copy_to_state(q, *state.get());
      goals->addState(state);
    }
    setup.setGoal(goals);
  }
  Asked(const Asked&) = delete;

  const ob::SpaceInformationPtr& information() const { return setup.getSpaceInformation(); }

  /// Sets it as the planner, with the scene. \param otherwise  as RecallPlanner's.
  RecallPlanner& plan_by(std::shared_ptr<const recall::RecallGuide> guide,
                         ob::PlannerPtr otherwise = nullptr) {
    const auto planner =
        std::make_shared<RecallPlanner>(information(), std::move(guide), std::move(otherwise));
    planner->set_scene(posed.surroundings.T_task_base, posed.surroundings.scene.objects);
    setup.setPlanner(planner);
    return *planner;
  }

  ob::PlannerSolution solution() const {
    ob::PlannerSolution solution(nullptr);
    EXPECT_TRUE(setup.getProblemDefinition()->getSolution(solution));
    return solution;
  }

  const recall::PosedQuery posed;
  collision::CollisionWorld world{made_shelf().cell.solids, posed.surroundings};

 private:
  const ob::StateSpacePtr space_ = make_state_space(posed.bounds);

 public:
  og::SimpleSetup setup{space_};
};

class RecallPlannerTest : public testing::Test {
 protected:
  RecallPlannerTest() { ompl::msg::noOutputHandler(); }

  static std::vector<std::unique_ptr<Asked>> fresh() {
    std::vector<std::unique_ptr<Asked>> asked;
    for (recall::PosedQuery& posed : made_shelf().cell.queries(100, 8))
      asked.push_back(std::make_unique<Asked>(std::move(posed)));
    return asked;
  }
  /// One whose path is recalled, solved.
  static std::unique_ptr<Asked> recalled() {
    for (auto& asked : fresh()) {
      const RecallPlanner& planner = asked->plan_by(patient_guide());
      asked->setup.solve(kEnough_s);
      if (planner.recalled().waypoints && !planner.recalled().is_straight_line)
        return std::move(asked);
    }
    throw std::logic_error("no query is recalled");
  }
};

TEST_F(RecallPlannerTest, SolvesWhatItRecallsAndLeavesTheRestToTheOther) {
  int recalled = 0;
  for (auto& asked : fresh()) {
    const RecallPlanner& planner = asked->plan_by(patient_guide());
    ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
    const bool is_recalled = planner.recalled().waypoints.has_value();
    recalled += is_recalled ? 1 : 0;
    EXPECT_EQ(asked->solution().plannerName_ == "Recall", is_recalled);
    EXPECT_EQ(planner.getPlannerProgressProperties().at("recalled BOOLEAN")(),
              is_recalled ? "1" : "0");
    EXPECT_EQ(planner.getPlannerProgressProperties().at("recall tries INTEGER")(),
              std::to_string(planner.recalled().tries));
    og::PathGeometric& path = asked->setup.getSolutionPath();
    EXPECT_TRUE(path.check());
    EXPECT_EQ(to_configuration(*path.getState(0), asked->posed.start.size()), asked->posed.start);
    EXPECT_TRUE(asked->setup.getGoal()->isSatisfied(path.getStates().back()));
  }
  EXPECT_GT(recalled, 0);
}

TEST_F(RecallPlannerTest, RecallsAsTheLibraryDoesInThisScene) {
  const auto asked = recalled();
  const auto guide = patient_guide();
  collision::CollisionWorld world(made_shelf().cell.solids, asked->posed.surroundings);
  const ob::SpaceInformationPtr& information = asked->information();
  const planning::IsFree is_free =
      planning::free_in(world).with_edges([&](const auto& from, const auto& to) {
        ob::ScopedState<> first(information), second(information);
        planning::IsFree::Lines lines;
        for (Eigen::Index i = 0; i < from.cols(); ++i) {
          copy_to_state(from.col(i), *first.get());
          copy_to_state(to.col(i), *second.get());
          lines.push_back(information->checkMotion(first.get(), second.get()));
        }
        return lines;
      });
  const auto found = recall::recall(
      *guide, recall::test_support::asked(made_shelf().cell, guide->library(), asked->posed, false),
      is_free, {.step = information->getStateSpace()->getLongestValidSegmentLength()});
  const auto& planner = dynamic_cast<const RecallPlanner&>(*asked->setup.getPlanner());
  EXPECT_EQ(found.waypoints, planner.recalled().waypoints);
  EXPECT_EQ(found.tries, planner.recalled().tries);
  EXPECT_EQ(found.collision_checks, planner.recalled().collision_checks);
}

TEST_F(RecallPlannerTest, NoPathHasAMotionThatTheValidatorRefuses) {
  for (auto& asked : fresh()) {
    const RecallPlanner& planner = asked->plan_by(patient_guide());
    asked->information()->setMotionValidator(std::make_shared<NoMotion>(asked->information()));
    ob::IterationTerminationCondition few(20'000);
    EXPECT_NE(asked->setup.solve(few), ob::PlannerStatus::EXACT_SOLUTION);
    EXPECT_FALSE(planner.recalled().waypoints);
    EXPECT_GT(planner.recalled().tries, 0U);
  }
}

TEST_F(RecallPlannerTest, WithoutPathsTheOtherPlannerPlans) {
  const auto asked = recalled();
  asked->setup.clear();
  asked->plan_by(nullptr);
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(asked->solution().plannerName_, "RRTConnect");
  asked->setup.clear();
  const auto rrt = std::make_shared<og::RRT>(asked->information());
  RecallPlanner& planner = asked->plan_by(patient_guide(), rrt);
  EXPECT_EQ(planner.otherwise(), rrt);
  planner.params().setParam("trust", "0");
  ob::IterationTerminationCondition few(500);
  asked->setup.solve(few);
  EXPECT_EQ(planner.recalled().tries, 0U);
  ob::PlannerData tree(asked->information());
  planner.getPlannerData(tree);
  EXPECT_GT(tree.numVertices(), 1U) << "the other planner's";
  planner.params().setParam("trust", "1");
  asked->setup.clear();
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(asked->solution().plannerName_, "Recall");
}

TEST_F(RecallPlannerTest, ItsDataAreThePathThatItRecalled) {
  const auto asked = recalled();
  ob::PlannerData data(asked->information());
  asked->setup.getPlanner()->getPlannerData(data);
  og::PathGeometric& path = asked->setup.getSolutionPath();
  ASSERT_EQ(data.numVertices(), path.getStateCount());
  EXPECT_EQ(data.numEdges(), path.getStateCount() - 1);
  EXPECT_EQ(data.getStartVertex(0).getState(), path.getState(0));
  EXPECT_EQ(data.getGoalVertex(0).getState(), path.getStates().back());
}

TEST_F(RecallPlannerTest, AClearedPlannerRecallsTheSameAgain) {
  const auto asked = recalled();
  const auto& planner = dynamic_cast<const RecallPlanner&>(*asked->setup.getPlanner());
  const recall::RecallSummary first = planner.recalled();
  asked->setup.clear();
  EXPECT_FALSE(planner.recalled().waypoints);
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(planner.recalled().waypoints, first.waypoints);
}

TEST_F(RecallPlannerTest, AClearedQueryIsRecalledAgain) {
  const auto asked = recalled();
  auto& planner = dynamic_cast<RecallPlanner&>(*asked->setup.getPlanner());
  const recall::RecallSummary first = planner.recalled();
  planner.clearQuery();
  EXPECT_FALSE(planner.recalled().waypoints);
  asked->setup.getProblemDefinition()->clearSolutionPaths();
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(planner.recalled().waypoints, first.waypoints);
}

TEST_F(RecallPlannerTest, AnInvalidGoalHidesNoneBehindIt) {
  const auto asked = recalled();
  asked->setup.clear();
  const auto goals = std::make_shared<ob::GoalStates>(asked->information());
  ob::ScopedState<> state(asked->information());
  copy_to_state(asked->posed.bounds.row(1).transpose().array() + 1, *state.get());
  goals->addState(state);
  for (const auto& q : asked->posed.goals.colwise()) {
    copy_to_state(q, *state.get());
    goals->addState(state);
  }
  asked->setup.setGoal(goals);
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(asked->solution().plannerName_, "Recall");
}

TEST_F(RecallPlannerTest, GoesOnWithoutWaitingForGoalsThatMayStillCome) {
  const auto asked = recalled();
  asked->setup.clear();
  asked->plan_by(patient_guide(), std::make_shared<og::RRT>(asked->information()));
  std::promise<void> is_done;
  bool is_first = true;
  const auto goals = std::make_shared<ob::GoalLazySamples>(
      asked->information(), [&](const ob::GoalLazySamples*, ob::State* state) {
        if (!std::exchange(is_first, false)) {
          is_done.get_future().wait();
          return false;
        }
        copy_to_state(asked->posed.goals.col(0), *state);
        return true;
      });
  asked->setup.setGoal(goals);
  ASSERT_EQ(asked->setup.solve(kEnough_s), ob::PlannerStatus::EXACT_SOLUTION);
  EXPECT_EQ(asked->solution().plannerName_, "Recall");
  ob::IterationTerminationCondition few(200);
  asked->setup.solve(few);
  ob::PlannerData tree(asked->information());
  asked->setup.getPlanner()->getPlannerData(tree);
  EXPECT_GT(tree.numVertices(), 1U) << "the other planner had no time left";
  is_done.set_value();
  goals->stopSampling();
}

TEST_F(RecallPlannerTest, NothingIsAskedWhenTheTimeIsOver) {
  const auto asked = recalled();
  asked->setup.clear();
  const std::uint64_t before = asked->world.checks();
  EXPECT_NE(asked->setup.solve(ob::plannerAlwaysTerminatingCondition()),
            ob::PlannerStatus::EXACT_SOLUTION);
  const auto& planner = dynamic_cast<const RecallPlanner&>(*asked->setup.getPlanner());
  EXPECT_EQ(planner.recalled().tries, 0U);
  EXPECT_LE(asked->world.checks() - before, 2U * (1 + asked->posed.goals.cols()))
      << "OMPL asks for start and goals as it takes them up";
}

TEST_F(RecallPlannerTest, TrustsPathsLessThatDoNotHoldUnlessItIsTold) {
  const auto asked = recalled();
  RecallPlanner& planner = asked->plan_by(patient_guide());
  asked->information()->setMotionValidator(std::make_shared<NoMotion>(asked->information()));
  const auto trust = [&] {
    std::string text;
    planner.params().getParam("trust", text);
    return std::stod(text);
  };
  EXPECT_EQ(trust(), 1);
  for (int times = 0; times < 3; ++times) {
    asked->setup.clear();
    ob::IterationTerminationCondition few(20'000);
    asked->setup.solve(few);
  }
  EXPECT_LT(trust(), 0.6);
  planner.params().setParam("trust", "0.9");
  EXPECT_EQ(trust(), 0.9);
  EXPECT_FALSE(planner.params().setParam("trust", "1.5"));
  EXPECT_EQ(trust(), 0.9);
}

TEST_F(RecallPlannerTest, RefusesSpacesThatAreNotTheRobots) {
  const auto pose = std::make_shared<ob::SpaceInformation>(std::make_shared<ob::SE3StateSpace>());
  EXPECT_THROW(RecallPlanner(pose, nullptr), std::invalid_argument);
  const auto six = std::make_shared<ob::SpaceInformation>(
      make_state_space(Eigen::Matrix2Xd::Random(2, 6).colwise() + Eigen::Vector2d(-2, 2)));
  EXPECT_THROW(RecallPlanner(six, patient_guide()), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::ompl_planners::recall_planner_test
