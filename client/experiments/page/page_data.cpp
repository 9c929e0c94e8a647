#include "client/experiments/page/page_data.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include "client/experiments/result_file.hpp"
#include "client/files/lines.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::experiments {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kSamples = 1500;
constexpr Eigen::Index kCheckedSamples = 500;  // for how many of them are free
constexpr std::size_t kPostures = 5;
constexpr double kPathStep = 0.2;  // joint units between drawn poses

models::LoadedRobot load(const std::filesystem::path& model) {
  models::RobotArguments arguments;
  arguments.source = model;
  return models::load_robot(arguments).value_or_throw();
}

std::vector<Problem> read_problems(const std::filesystem::path& file) {
  std::vector<Problem> problems;
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    Result<Problem> problem = json::problem_from_json(std::string(line.text.value()));
    if (!problem)
      throw Failure(problem.error().code, file.string() + " line " + std::to_string(line.number) +
                                              ": " + problem.error().message);
    problems.push_back(*std::move(problem));
    return true;
  });
  if (problems.empty())
    throw Failure(ErrorCode::InvalidInput, "'" + file.string() + "' holds no problem");
  return problems;
}

Distribution read_distribution(const std::filesystem::path& file) {
  std::ifstream stream = files::open_input(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Result<Distribution> distribution = json::distribution_from_json(text);
  if (!distribution)
    throw Failure(distribution.error().code, file.string() + ": " + distribution.error().message);
  if (!distribution->mixture)
    throw Failure(ErrorCode::InvalidInput, file.string() + ": the distribution has no mixture");
  return *std::move(distribution);
}

/// \param configurations  dof x n.
Poses poses_of(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
               const Eigen::MatrixXd& configurations) {
  Poses poses{Eigen::Matrix3Xd(3, configurations.cols()),
              Eigen::Matrix3Xd(3, configurations.cols())};
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    const Eigen::Isometry3d T_task_transfer =
        T_task_base * kinematics::T_base_transfer(chain, configurations.col(i));
    poses.positions.col(i) = T_task_transfer.translation();
    poses.directions.col(i) = T_task_transfer.linear().col(2);
  }
  return poses;
}

FleetMember read_member(const RunFolder& run, const std::string& name) {
  const models::LoadedRobot robot = load(run.models / name);
  std::map<std::string, Eigen::Isometry3d> placements;
  for (const Problem& problem : read_problems(run.folder / (name + ".problems.jsonl")))
    placements.emplace(problem.name, problem.T_task_base.value_or(Eigen::Isometry3d::Identity()));
  FleetMember member;
  member.label = robot.description.label;
  for (const ProblemResult& result : read_results(run.folder / (name + ".results.jsonl"))) {
    ++member.problems;
    const auto placement = placements.find(result.name);
    if (!result.waypoints || placement == placements.end())
      continue;
    if (result.waypoints->rows() != robot.chain.dof())
      throw Failure(ErrorCode::InvalidInput, name + ": the path of '" + result.name + "' has " +
                                                 std::to_string(result.waypoints->rows()) +
                                                 " joints, the robot " +
                                                 std::to_string(robot.chain.dof()));
    member.paths.push_back(poses_of(robot.chain, placement->second,
                                    planning::densified(*result.waypoints, kPathStep)));
  }
  return member;
}

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

void add_samples(const models::LoadedRobot& robot, const Problem& problem, PageData& data) {
  const Distribution& distribution = data.distribution;
  if (distribution.mixture->dimension() != robot.chain.dof())
    throw Failure(ErrorCode::InvalidInput, "distribution.json has " +
                                               std::to_string(distribution.mixture->dimension()) +
                                               " joints, " + robot.description.label + " " +
                                               std::to_string(robot.chain.dof()));
  const Eigen::Isometry3d T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  collision::CollisionWorld world(robot.chain, robot.shapes,
                                  {T_task_base, problem.scene, {}, problem.allowed_collisions});
  std::mt19937_64 generator(kSeed);
  const Eigen::MatrixXd samples = draw(distribution, generator);
  const Eigen::MatrixXd uniform = draw_uniform(distribution.limits, generator);
  const std::vector<Eigen::Index> free = free_ones(world, samples);
  data.samples = poses_of(robot.chain, T_task_base, samples);
  data.free_share = share_of(free, samples.cols());
  data.uniform_free_share = share_of(free_ones(world, uniform), uniform.cols());
  for (const Eigen::Index index : far_apart(free, data.samples.positions))
    data.postures.push_back(page::bones_of(robot, T_task_base, samples.col(index)));
}

std::vector<double> checks_of(const std::vector<ProblemResult>& results) {
  std::vector<double> checks;
  for (const ProblemResult& result : results)
    checks.push_back(static_cast<double>(result.collision_checks));
  return checks;
}

}  // namespace

PageData read_run(const RunFolder& run) {
  PageData data;
  for (const std::string& name : run.fleet)
    data.fleet.push_back(read_member(run, name));
  const models::LoadedRobot robot = load(run.models / run.robot);
  data.robot = robot.description.label;
  const Problem problem = read_problems(run.folder / (run.robot + ".problems.jsonl")).front();
  data.scene = problem.scene;
  data.distribution = read_distribution(run.folder / "distribution.json");
  data.advice = read_distribution(run.folder / "advice.json").advice;
  add_samples(robot, problem, data);
  const auto uniform = read_results(run.folder / (run.robot + "-uniform.results.jsonl"));
  const auto guided = read_results(run.folder / (run.robot + "-guided.results.jsonl"));
  data.comparison = compare(uniform, guided).value_or_throw();
  data.uniform_checks = mean_interval(checks_of(uniform));
  data.guided_checks = mean_interval(checks_of(guided));
  return data;
}

}  // namespace kinship::experiments
