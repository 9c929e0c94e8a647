// 08: Plan as kinship-plan does: the distribution, stored ways of the hand and a retreat together,
// some queries planned uniformly to compare, every attempt reported with its scene.
//
//   08_plan_as_kinship_plan MODELS
#include <iostream>
#include <kinship/planning.hpp>

using namespace kinship;

/// From one side of a post to the other.
Problem around_a_post(std::uint64_t seed) {
  Problem problem;
  problem.name = "post " + std::to_string(seed);
  problem.T_task_base = Eigen::Isometry3d::Identity();
  problem.start = Eigen::VectorXd{{-0.9, -1.4, 1.9, -2.07, -1.57, 0}};
  problem.goal_configurations = Eigen::VectorXd{{0.9, -1.4, 1.9, -2.07, -1.57, 0}};
  problem.scene.objects.push_back(
      {"post", CylinderShape{0.05, 1.0}, Eigen::Isometry3d(Eigen::Translation3d(0.75, 0, 0.5))});
  problem.seed = seed;
  return problem;
}

int main(int count, char** words) try {
  if (count != 2)
    throw std::runtime_error("usage: 08_plan_as_kinship_plan MODELS");
  const auto arm =
      models::load_robot({.source = std::string(words[1]) + "/ur10e"}).value_or_throw();
  const guided::PlannedRobot robot(arm.chain, arm.shapes);
  link::Client client(link::options_from_environment());
  client.register_robot(arm).value_or_throw();

  guided::GuidanceOptions wanted;
  wanted.task = "sweep";
  wanted.robot = arm.chain.digest();
  wanted.dof = arm.chain.dof();
  wanted.chain = arm.chain;  // follows the stored ways
  guided::GuidanceCache guidance([&](const FetchRequest& request) { return client.fetch(request); },
                                 wanted);
  const guided::PlanSettings settings;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Problem problem = around_a_post(seed);
    if (const auto [answer, is_new] = guidance.ask(problem); is_new)
      std::cout << answer.message << '\n';  // without a server too: planned uniformly then
    const guided::PlannedProblem planned = guided::plan_problem(
        robot, problem, guidance.choose(problem), settings, [] { return false; });
    guidance.add(planned);
    std::cout << problem.name << (planned.result.solved ? " solved with " : " not solved with ")
              << planned.result.collision_checks << " checks\n";
    Attempt attempt =
        guided::make_attempt({robot, "cell 4", wanted.task}, problem, planned, settings);
    attempt.scene = guided::record_scene(arm.chain, problem).value_or_throw();
    client.report(attempt);
  }
  std::cout << "pending " << client.flush(std::chrono::seconds(30)).pending << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
