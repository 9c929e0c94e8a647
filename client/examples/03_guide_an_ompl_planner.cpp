// 03: Guide a planner of OMPL. Wherever it would draw uniformly it draws from the fleet's
// experience.
//
//   03_guide_an_ompl_planner MODELS
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <iostream>
#include <kinship/planning.hpp>

using namespace kinship;
namespace ob = ompl::base;

int main(int count, char** words) try {
  if (count != 2)
    throw std::runtime_error("usage: 03_guide_an_ompl_planner MODELS");
  // The same arm as in 02, with the shapes of its links.
  const auto arm =
      models::load_robot({.source = std::string(words[1]) + "/ur10e"}).value_or_throw();
  Scene scene;
  scene.objects.push_back(
      {"post", CylinderShape{0.05, 0.6}, Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.3))});
  collision::CollisionWorld world(arm.chain, arm.shapes,
                                  {Eigen::Isometry3d::Identity(), scene, {}, {}});
  const Eigen::VectorXd start{{-0.9, -1.4, 1.9, -2.07, -1.57, 0}};
  const Eigen::VectorXd goal{{0.9, -1.4, 1.9, -2.07, -1.57, 0}};

  link::Client client(link::options_from_environment());
  FetchRequest request;
  request.task = "sweep";
  request.robot = client.register_robot(arm).value_or_throw().robot;
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.deadline = std::chrono::seconds(60);
  const Distribution distribution = client.fetch(request).value_or_throw().distribution.value();

  const Eigen::Matrix2Xd bounds = planning::planning_bounds(arm.chain, start);
  const auto space = ompl_planners::make_state_space(bounds);
  ompl_planners::install_guided_sampler(
      *space,
      std::make_shared<const planning::ConfigurationSampler>(
          bounds, arm.chain, distribution.mixture.value(), distribution.advice.recommended_share),
      1);
  ompl::geometric::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* state) {
    return !world.collides(ompl_planners::to_configuration(*state, arm.chain.dof()));
  });
  ob::ScopedState<> from(space), to(space);
  ompl_planners::copy_to_state(start, *from.get());
  ompl_planners::copy_to_state(goal, *to.get());
  setup.setStartAndGoalStates(from, to);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(setup.getSpaceInformation()));
  const bool solved = setup.solve(20) == ob::PlannerStatus::EXACT_SOLUTION;
  std::cout << (solved ? "solved" : "not solved") << " with " << world.checks() << " checks\n";
  return solved ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
