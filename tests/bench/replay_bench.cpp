// Collision checks per second in the scene of the study `cobots`: what uniform queries of its
// calibration instances asked for is asked again, in the same order, without anything else.
//
//     replay_bench [MODELS] [INSTANCES]

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "client/planning/cbirrt2.hpp"
#include "client/planning/configuration_sampler.hpp"
#include "client/planning/planning_bounds.hpp"
#include "client/planning/region_constraint.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::bench {
namespace {

double thread_time_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

collision::CollisionWorld make_world(const models::LoadedRobot& robot, const Problem& problem) {
  return {
      robot.chain,
      robot.shapes,
      {problem.T_task_base.value(), problem.scene, problem.attached, problem.allowed_collisions}};
}

/// Every configuration that uniform planning of a problem asks for.
std::vector<Eigen::VectorXd> asked_for(const models::LoadedRobot& robot, const Problem& problem,
                                       const plan::PlanSettings& settings) {
  collision::CollisionWorld world = make_world(robot, problem);
  std::vector<Eigen::VectorXd> asked;
  const planning::IsFree is_free = [&](const Eigen::VectorXd& q) {
    asked.push_back(q);
    return !world.collides(q);
  };
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, problem.start);
  planning::RegionConstraint constraint(robot.chain, problem.constraint.value(),
                                        *problem.T_task_base, bounds);
  planning::BirrtOptions options;
  options.step = settings.resolution;
  options.overshoot = 1;
  options.max_checks = settings.max_checks;
  std::mt19937_64 generator(problem.seed);
  planning::plan_cbirrt2(problem.start, problem.goal_configurations, {is_free, constraint},
                         planning::ConfigurationSampler(bounds), options, generator);
  return asked;
}

struct Replay {
  std::size_t checks = 0, colliding = 0;
  double time_s = 0;

  void add(const models::LoadedRobot& robot, const Problem& problem,
           const std::vector<Eigen::VectorXd>& asked) {
    collision::CollisionWorld world = make_world(robot, problem);
    const double begin_s = thread_time_s();
    for (const Eigen::VectorXd& q : asked)
      colliding += world.collides(q) ? 1U : 0U;
    time_s += thread_time_s() - begin_s;
    checks += asked.size();
  }
};

void replay_robot(const experiments::Study& study, std::size_t number, const std::string& models,
                  std::uint32_t instances) {
  const experiments::StudyRobot& placed = study.robots.at(number);
  const models::LoadedRobot robot =
      models::load_robot({.source = models + "/" + placed.model}).value_or_throw();
  const experiments::DrawInstance draw = study.make_instances(robot, placed);
  Replay replay;
  for (std::uint32_t index = 0; index < instances; ++index) {
    const Problem problem =
        draw(experiments::seed_of(experiments::InstanceSet::Calibration, 0), index);
    replay.add(robot, problem, asked_for(robot, problem, study.settings));
  }
  const auto checks = static_cast<double>(replay.checks);
  std::printf("%-10s %8zu checks, %2.0f %% colliding, %.2f us a check, %.0f checks/s\n",
              placed.model.c_str(), replay.checks,
              100 * static_cast<double>(replay.colliding) / checks, 1e6 * replay.time_s / checks,
              checks / replay.time_s);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  constexpr std::uint32_t kInstances = 20;
  const std::string models = argc > 1 ? argv[1] : "robots/models";
  const std::uint32_t instances =
      argc > 2 ? static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10)) : kInstances;
  const kinship::experiments::Study& study = kinship::experiments::find_study("cobots");
  for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
    kinship::bench::replay_robot(study, robot, models, instances);
  return 0;
}
