#include "client/experiments/page/page_data.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "client/experiments/page/run_reader.hpp"
#include "client/experiments/python_program.hpp"
#include "client/experiments/result_file.hpp"
#include "client/page/drawn_scene.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/planning/configuration_sampler.hpp"

namespace kinship::experiments {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kSamples = 1500;
constexpr Eigen::Index kCheckedSamples = 500;  // for how many of them are free
constexpr std::size_t kPostures = 5;

/// Draws `kSamples` configurations, one per column; fewer if the mixture lies outside the limits.
Eigen::MatrixXd draw(const Distribution& distribution, std::mt19937_64& generator) {
  const mixture::DistributionSampler sampler(distribution);
  Eigen::MatrixXd samples(sampler.dimension(), kSamples);
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < kSamples; ++i)
    if (const auto q = sampler.sample(generator))
      samples.col(count++) = *q;
  return samples.leftCols(count);
}

Eigen::MatrixXd draw_uniform(const Eigen::Matrix2Xd& limits, std::mt19937_64& generator) {
  const planning::ConfigurationSampler sampler(limits);
  Eigen::MatrixXd samples(limits.cols(), kSamples);
  for (auto column : samples.colwise())
    column = sampler.sample(generator);
  return samples;
}

/// Of the first `kCheckedSamples`.
std::vector<Eigen::Index> free_ones(collision::CollisionWorld& world,
                                    const Eigen::MatrixXd& configurations) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < std::min(configurations.cols(), kCheckedSamples); ++i)
    if (!world.collides(configurations.col(i)))
      free.push_back(i);
  return free;
}

/// Of those that were checked.
double share_of(const std::vector<Eigen::Index>& some, Eigen::Index all) {
  all = std::min(all, kCheckedSamples);
  return all == 0 ? 0 : static_cast<double>(some.size()) / static_cast<double>(all);
}

/// Each chosen one is the one whose transfer frame is farthest from those chosen before.
std::vector<Eigen::Index> far_apart(const std::vector<Eigen::Index>& candidates,
                                    const Eigen::Matrix3Xd& positions) {
  std::vector<Eigen::Index> chosen;
  if (!candidates.empty())
    chosen.push_back(candidates.front());
  const auto distance = [&](Eigen::Index candidate) {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Index each : chosen)
      least = std::min(least, (positions.col(candidate) - positions.col(each)).norm());
    return least;
  };
  while (!chosen.empty() && chosen.size() < std::min(kPostures, candidates.size()))
    chosen.push_back(*std::max_element(
        candidates.begin(), candidates.end(),
        [&](Eigen::Index a, Eigen::Index b) { return distance(a) < distance(b); }));
  return chosen;
}

DrawnSamples draw_samples(const models::LoadedRobot& robot, const Problem& problem,
                          const Distribution& distribution, const std::filesystem::path& file) {
  if (distribution.mixture->dimension() != robot.chain.dof())
    throw Failure(ErrorCode::InvalidInput, file.string() + " has " +
                                               std::to_string(distribution.mixture->dimension()) +
                                               " joints, " + robot.description.label + " " +
                                               std::to_string(robot.chain.dof()));
  const Eigen::Isometry3d T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  collision::CollisionWorld world(
      robot.chain, robot.shapes,
      {T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
  std::mt19937_64 generator(kSeed);
  const Eigen::MatrixXd samples = draw(distribution, generator);
  const Eigen::MatrixXd uniform = draw_uniform(distribution.limits, generator);
  const std::vector<Eigen::Index> free = free_ones(world, samples);
  DrawnSamples drawn{poses_of(robot.chain, T_task_base, samples),
                     share_of(free, samples.cols()),
                     share_of(free_ones(world, uniform), uniform.cols()),
                     {}};
  for (const Eigen::Index index : far_apart(free, drawn.hand.positions))
    drawn.postures.push_back(page::bones_of(robot, T_task_base, samples.col(index)));
  return drawn;
}

/// The statistics of the run.
nlohmann::ordered_json figures_of(const RunFiles& run) {
  nlohmann::ordered_json asked{{"uniform", run.uniform.string()},
                               {"guided", run.guided.string()},
                               {"also", nlohmann::ordered_json::array()},
                               {"as", "page"}};
  for (const AlsoFile& also : run.also)
    asked["also"].push_back({also.name, also.results.string()});
  return nlohmann::ordered_json::parse(
      output_of_python(python_folder() / "compare.py", {asked.dump()}));
}

const ProblemResult& named(const std::vector<ProblemResult>& results, const std::string& name) {
  return *std::ranges::find(results, name, &ProblemResult::name);
}

/// Of one instance, if both searches are there and have nodes.
std::optional<SearchPair> find_searches(const RunFiles& run, const models::LoadedRobot& robot,
                                        const Problem& problem) {
  const auto uniform = read_searches(run.uniform_searches);
  const auto guided = read_searches(run.guided_searches);
  const auto u = uniform.find(problem.name);
  const auto g = guided.find(problem.name);
  if (u == uniform.end() || g == guided.end() || u->second.parents.empty() ||
      g->second.parents.empty())
    return std::nullopt;
  return SearchPair{grown(robot, problem, u->second), grown(robot, problem, g->second)};
}

}  // namespace

PageData read_run(const RunFiles& run) {
  PageData data;
  for (const TeacherFiles& teacher : run.teachers)
    data.fleet.push_back(read_member(teacher));
  const models::LoadedRobot robot = models::load_robot(run.robot).value_or_throw();
  data.robot = robot.description.label;
  const auto problems = read_problems(run.problems, run.robot);
  const auto uniform = read_results(run.uniform);
  const auto guided = read_results(run.guided);
  data.figures = figures_of(run);
  data.distribution = read_distribution(run.distribution);
  if (!run.advice.empty())
    data.advice = read_distribution(run.advice).advice;

  const nlohmann::ordered_json& typical = data.figures.at("typical");
  const Problem& shown = problem_of(
      problems, typical.is_null() ? uniform.front().name : typical.at("problem").get<std::string>(),
      run.uniform);
  for (const AttachedObject& each : shown.attached)
    data.held.push_back(each.name);
  data.obstacles = page::drawn_objects(shown.scene);
  if (!typical.is_null()) {
    const ProblemResult& result = named(guided, shown.name);
    data.newcomer =
        demonstrate(robot, shown, checked_path(robot, result, run.guided), result.collision_checks);
    data.searches = find_searches(run, robot, shown);
  }
  data.samples = draw_samples(robot, shown, data.distribution, run.distribution);
  return data;
}

}  // namespace kinship::experiments
