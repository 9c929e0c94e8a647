// 09: In the place of OMPL's Lightning: whole paths of the fleet's experience are tried first;
// where none is free, RRTConnect plans. Run 08 before, so that there is experience with scenes.
//
//   09_recall_in_ompl MODELS
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>

#include <iostream>
#include <kinship/planning.hpp>

using namespace kinship;
namespace ob = ompl::base;

int main(int count, char** words) try {
  if (count != 2)
    throw std::runtime_error("usage: 09_recall_in_ompl MODELS");
  const auto arm =
      models::load_robot({.source = std::string(words[1]) + "/ur10e"}).value_or_throw();
  Scene scene;
  scene.objects.push_back(
      {"post", CylinderShape{0.05, 1.0}, Eigen::Isometry3d(Eigen::Translation3d(0.75, 0, 0.5))});
  const Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  collision::CollisionWorld world(arm.chain, arm.shapes, {T_task_base, scene, {}, {}});
  const Eigen::VectorXd start{{-0.9, -1.4, 1.9, -2.07, -1.57, 0}};
  const Eigen::VectorXd goal{{0.8, -1.3, 1.8, -2.07, -1.57, 0}};

  link::Client client(link::options_from_environment());
  FetchRequest request;
  request.task = "sweep";
  request.robot = client.register_robot(arm).value_or_throw().robot;
  request.T_task_base = T_task_base;
  request.experience_bytes = kDefaultExperienceBytes;
  request.rehearsed = true;  // waits until the server has made the paths
  request.start.assign(start.begin(), start.end());
  request.deadline = std::chrono::seconds(60);
  const FetchReply reply = client.fetch(request).value_or_throw();
  std::shared_ptr<const recall::RecallGuide> guide;
  if (reply.recall && !reply.recall->paths.empty())
    guide = std::make_shared<const recall::RecallGuide>(arm.chain, *reply.recall);
  const auto space = ompl_planners::make_state_space(planning::planning_bounds(arm.chain, start));
  ompl::geometric::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* state) {
    return !world.collides(ompl_planners::to_configuration(*state, arm.chain.dof()));
  });
  ob::ScopedState<> from(space), to(space);
  ompl_planners::copy_to_state(start, *from.get());
  ompl_planners::copy_to_state(goal, *to.get());
  setup.setStartAndGoalStates(from, to);
  const auto& information = setup.getSpaceInformation();
  const auto planner = std::make_shared<ompl_planners::RecallPlanner>(information, guide);
  planner->set_scene(T_task_base, scene.objects);
  setup.setPlanner(planner);
  const bool solved = setup.solve(20) == ob::PlannerStatus::EXACT_SOLUTION;
  std::cout << (planner->recalled().waypoints ? "recalled" : "planned") << " with "
            << world.checks() << " checks\n";
  return solved ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
