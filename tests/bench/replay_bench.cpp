// Collision checks per second in the scene of the study `cobots`: what queries of its test
// instances asked for, uniform and guided ones, is asked again, in the same order, without anything
// else.
//
//     zstd -dc client/experiments/results/cobots/distributions.jsonl.zst >distributions.jsonl
//     replay_bench distributions.jsonl [MODELS] [INSTANCES]

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "client/files/lines.hpp"
#include "client/planning/cbirrt2.hpp"
#include "client/planning/configuration_sampler.hpp"
#include "client/planning/planning_bounds.hpp"
#include "client/planning/region_constraint.hpp"
#include "proto/json/distribution_json.hpp"
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

/// Every configuration that planning a problem asks for.
/// \param mixture  null: uniform.
std::vector<Eigen::VectorXd> asked_for(const models::LoadedRobot& robot, const Problem& problem,
                                       const experiments::Study& study, const Mixture* mixture) {
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
  options.step = study.settings.resolution;
  options.overshoot = study.settings.overshoot;
  options.max_checks = study.settings.max_checks;
  std::mt19937_64 generator(problem.seed);
  const planning::ConfigurationSampler sampler =
      mixture == nullptr
          ? planning::ConfigurationSampler(bounds)
          : planning::ConfigurationSampler(bounds, robot.chain, *mixture, study.guided_share);
  planning::plan_cbirrt2(problem.start, problem.goal_configurations, {is_free, constraint}, sampler,
                         options, generator);
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

std::vector<Distribution> read_distributions(const std::string& file) {
  std::ifstream stream(file);
  std::vector<Distribution> distributions;
  files::for_each_line(stream, file, [&](const files::Line& line) {
    if (!line.text)
      throw Failure(line.text.error());
    distributions.push_back(json::distribution_from_json(*line.text).value_or_throw());
    return true;
  });
  if (distributions.empty())
    throw Failure(ErrorCode::NotFound, file + ": no distributions");
  return distributions;
}

void print(const std::string& model, const char* queries, const Replay& replay) {
  const auto checks = static_cast<double>(replay.checks);
  std::printf("%-10s %-8s %8zu checks, %2.0f %% colliding, %.2f us a check, %.0f checks/s\n",
              model.c_str(), queries, replay.checks,
              100 * static_cast<double>(replay.colliding) / checks, 1e6 * replay.time_s / checks,
              checks / replay.time_s);
  std::fflush(stdout);
}

/// The first query of each instance, uniformly and guided by each distribution of the robot.
void replay_robot(const experiments::Study& study, std::size_t number, const std::string& models,
                  std::uint32_t instances, const std::vector<Distribution>& distributions) {
  const experiments::StudyRobot& placed = study.robots.at(number);
  const models::LoadedRobot robot =
      models::load_robot({.source = models + "/" + placed.model}).value_or_throw();
  const experiments::DrawInstance draw = study.make_instances(robot, placed);
  Replay uniform, guided;
  for (std::uint32_t index = 0; index < instances; ++index) {
    const Problem problem =
        draw(experiments::seed_of(experiments::InstanceSet::Test, number), index);
    uniform.add(robot, problem, asked_for(robot, problem, study, nullptr));
    for (const Distribution& distribution : distributions)
      if (distribution.robot == robot.chain.digest() && distribution.mixture)
        guided.add(robot, problem, asked_for(robot, problem, study, &*distribution.mixture));
  }
  print(placed.model, "uniform", uniform);
  print(placed.model, "guided", guided);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  constexpr std::uint32_t kInstances = 20;
  if (argc < 2) {
    std::fprintf(stderr, "usage: replay_bench DISTRIBUTIONS.jsonl [MODELS] [INSTANCES]\n");
    return 2;
  }
  const std::string models = argc > 2 ? argv[2] : "robots/models";
  const std::uint32_t instances =
      argc > 3 ? static_cast<std::uint32_t>(std::strtoul(argv[3], nullptr, 10)) : kInstances;
  const auto distributions = kinship::bench::read_distributions(argv[1]);
  const kinship::experiments::Study& study = kinship::experiments::find_study("cobots");
  for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
    kinship::bench::replay_robot(study, robot, models, instances, distributions);
  return 0;
}
