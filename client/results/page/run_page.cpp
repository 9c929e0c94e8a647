#include "client/results/page/run_page.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <random>
#include <utility>

#include "client/results/page/embedded_texts.hpp"
#include "client/results/page/run_files.hpp"
#include "pages/page/bones.hpp"
#include "pages/page/document.hpp"
#include "pages/page/json_text.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::results {
namespace {

using page::json_string;
using page::list;
using page::millimetres;
using page::number;
using page::object;

constexpr double kDrawnStep = 0.2;    // joint units between drawn poses of many paths
constexpr double kSmoothStep = 0.03;  // of one path
constexpr Eigen::Index kFrames = 60;
constexpr double kPercent = 100;
constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kSamples = 1500;
constexpr Eigen::Index kCheckedSamples = 500;  // for how many of them are free
constexpr std::size_t kPostures = 5;

Eigen::Isometry3d base_of(const Problem& problem) {
  return problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
}

/// Positions of the transfer frame, m, and its approach directions, in the task frame.
struct HandPoses {
  Eigen::Matrix3Xd positions, directions;

  std::string to_json() const {
    return object(
        {{"positions", millimetres(positions)}, {"directions", page::whole(directions, kPercent)}});
  }
};

/// \param configurations  dof x n.
HandPoses hand_poses(const models::LoadedRobot& robot, const Problem& problem,
                     const Eigen::MatrixXd& configurations) {
  HandPoses poses{Eigen::Matrix3Xd(3, configurations.cols()),
                  Eigen::Matrix3Xd(3, configurations.cols())};
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    const Eigen::Isometry3d T_task_transfer =
        base_of(problem) * kinematics::T_base_transfer(robot.chain, configurations.col(i));
    poses.positions.col(i) = T_task_transfer.translation();
    poses.directions.col(i) = T_task_transfer.linear().col(2);
  }
  return poses;
}

/// \throws Failure(InvalidInput) if something has another number of joints than the robot.
void check_joints(const models::LoadedRobot& robot, Eigen::Index joints, const std::string& what) {
  if (joints != robot.chain.dof())
    throw Failure(ErrorCode::InvalidInput, what + " has " + std::to_string(joints) + " joints, " +
                                               robot.description.label + " " +
                                               std::to_string(robot.chain.dof()));
}

/// The path of a result, if it is one of this robot. \param file  of the result.
const Eigen::MatrixXd& path_of(const models::LoadedRobot& robot, const ProblemResult& result,
                               const std::filesystem::path& file) {
  check_joints(robot, result.waypoints->rows(),
               file.string() + ": the path of '" + result.name + "'");
  return *result.waypoints;
}

/// The problem that a result answers. \param file  of the result.
const Problem& problem_of(const std::map<std::string, Problem>& problems, const std::string& name,
                          const std::filesystem::path& file) {
  const auto found = problems.find(name);
  if (found == problems.end())
    throw Failure(ErrorCode::InvalidInput, file.string() + " answers '" + name +
                                               "', which is none of the " +
                                               std::to_string(problems.size()) + " problems");
  return found->second;
}

/// A path as a page plays it: from start to goal, about equally far apart.
std::string demonstration(const models::LoadedRobot& robot, const Problem& problem,
                          const Eigen::MatrixXd& waypoints, std::uint64_t checks) {
  const Eigen::MatrixXd path = planning::densified(waypoints, kSmoothStep);
  const Eigen::Index count = std::min(kFrames, path.cols());
  std::vector<Eigen::VectorXd> shown;
  for (Eigen::Index i = 0; i < count; ++i)
    shown.emplace_back(path.col(count == 1 ? 0 : i * (path.cols() - 1) / (count - 1)));
  const auto frame = [&](const Eigen::VectorXd& q) {
    return object({{"bones", page::json_of(page::bones_of(robot, base_of(problem), q))},
                   {"held", page::json_of(page::held_objects(robot, problem.attached,
                                                             base_of(problem), q))}});
  };
  return object({{"problem", json_string(problem.name)},
                 {"checks", std::to_string(checks)},
                 {"obstacles", page::json_of(page::drawn_objects(problem.scene))},
                 {"way", millimetres(hand_poses(robot, problem, path).positions)},
                 {"frames", list(shown, frame)}});
}

/// An experienced robot: all its paths, and the solved problem with the median number of checks.
std::string fleet_member(const TeacherFiles& files) {
  const models::RobotArguments arguments{.source = files.model};
  const models::LoadedRobot robot = models::load_robot(arguments).value_or_throw();
  const auto problems = read_problems(files.problems, arguments);
  const auto results = read_results(files.results);
  std::vector<const ProblemResult*> solved;
  for (const ProblemResult& result : results)
    if (result.waypoints)
      solved.push_back(&result);
  const auto drawn = [&](const ProblemResult* result) {
    const Problem& problem = problem_of(problems, result->name, files.results);
    return hand_poses(robot, problem,
                      planning::densified(path_of(robot, *result, files.results), kDrawnStep))
        .to_json();
  };
  const std::string paths = list(solved, drawn);
  std::ranges::stable_sort(solved, {}, &ProblemResult::collision_checks);
  const ProblemResult* const median = solved.empty() ? nullptr : solved[(solved.size() - 1) / 2];
  return object({{"label", json_string(robot.description.label)},
                 {"problems", std::to_string(results.size())},
                 {"paths", paths},
                 {"example", median == nullptr
                                 ? "null"
                                 : demonstration(robot, problems.at(median->name),
                                                 *median->waypoints, median->collision_checks)}});
}

template <typename Number>
std::string numbers(const std::vector<Number>& values) {
  return list(values, [](Number value) { return std::to_string(value); });
}

/// A search by the position of the hand in each node.
std::string grown_search(const models::LoadedRobot& robot, const Problem& problem,
                         const RecordedSearch& search) {
  check_joints(robot, search.nodes.rows(), "the search of '" + search.name + "'");
  return object({{"hand", millimetres(hand_poses(robot, problem, search.nodes).positions)},
                 {"parents", numbers(search.parents)},
                 {"checks", numbers(search.checks)},
                 {"path", numbers(search.path)}});
}

/// Of one instance; null unless both searches are there and have nodes.
std::string searches(const PageRun& run, const models::LoadedRobot& robot, const Problem& problem) {
  const auto uniform = read_searches(run.uniform_searches);
  const auto guided = read_searches(run.guided_searches);
  const auto u = uniform.find(problem.name);
  const auto g = guided.find(problem.name);
  if (u == uniform.end() || g == guided.end() || u->second.parents.empty() ||
      g->second.parents.empty())
    return "null";
  return object({{"uniform", grown_search(robot, problem, u->second)},
                 {"guided", grown_search(robot, problem, g->second)}});
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
std::string share_of(const std::vector<Eigen::Index>& some, Eigen::Index all) {
  all = std::min(all, kCheckedSamples);
  return number(all == 0 ? 0 : static_cast<double>(some.size()) / static_cast<double>(all));
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

/// Samples of the distribution in the scene that the page shows, some free ones as whole arms.
std::string drawn_samples(const models::LoadedRobot& robot, const Problem& problem,
                          const Distribution& distribution, const std::filesystem::path& file) {
  check_joints(robot, distribution.mixture->dimension(), file.string());
  collision::CollisionWorld world(
      robot.chain, robot.shapes,
      {base_of(problem), problem.scene, problem.attached, problem.allowed_collisions});
  std::mt19937_64 generator(kSeed);
  const Eigen::MatrixXd samples = draw(distribution, generator);
  const Eigen::MatrixXd uniform = draw_uniform(distribution.limits, generator);
  const std::vector<Eigen::Index> free = free_ones(world, samples);
  const HandPoses hand = hand_poses(robot, problem, samples);
  const auto posture = [&](Eigen::Index i) {
    return page::json_of(page::bones_of(robot, base_of(problem), samples.col(i)));
  };
  return object({{"hand", hand.to_json()},
                 {"free_share", share_of(free, samples.cols())},
                 {"uniform_free_share", share_of(free_ones(world, uniform), uniform.cols())},
                 {"postures", list(far_apart(free, hand.positions), posture)}});
}

std::string json_of(const Source& source) {
  return object({{"label", json_string(source.label)},
                 {"paths", std::to_string(source.paths)},
                 {"poses", std::to_string(source.poses)},
                 {"poses_solved", std::to_string(source.poses_solved)}});
}

std::string json_of(const Distribution& distribution) {
  return object({{"id", json_string(distribution.id.short_hex())},
                 {"revision", std::to_string(distribution.revision)},
                 {"task", json_string(distribution.task)},
                 {"profile", json_string(distribution.profile)},
                 {"components", std::to_string(distribution.mixture->size())},
                 {"joints", std::to_string(distribution.mixture->dimension())},
                 {"configurations", std::to_string(distribution.configurations)},
                 {"transfer_time_s", number(distribution.transfer_time_s)},
                 {"fit_time_s", number(distribution.fit_time_s)},
                 {"sources", list(distribution.sources,
                                  [](const Source& source) { return json_of(source); })}});
}

/// The server's advice after the attempts of the run; null without such a file.
std::string advice(const std::filesystem::path& file) {
  if (file.empty())
    return "null";
  const Advice advice = read_distribution(file).advice;
  return object(
      {{"share", number(advice.recommended_share)}, {"evidence", json_string(advice.evidence)}});
}

/// The page's data: lengths as whole millimetres, directions as whole percents.
std::string data_of(const PageRun& run, const models::LoadedRobot& robot) {
  const std::string fleet = list(run.teachers, fleet_member);
  const auto problems = read_problems(run.problems, run.robot);
  const auto guided = read_results(run.guided);
  const Distribution distribution = read_distribution(run.distribution);
  const Problem& shown = problem_of(problems, run.shown, run.uniform);
  std::string newcomer = "null", grown = "null";
  if (!run.figures.at("typical").is_null()) {
    const ProblemResult& result = *std::ranges::find(guided, run.shown, &ProblemResult::name);
    newcomer =
        demonstration(robot, shown, path_of(robot, result, run.guided), result.collision_checks);
    grown = searches(run, robot, shown);
  }
  std::string data =
      object({{"robot", json_string(robot.description.label)},
              {"held", list(shown.attached,
                            [](const AttachedObject& each) { return json_string(each.name); })},
              {"fleet", fleet},
              {"distribution", json_of(distribution)},
              {"advice", advice(run.advice)},
              {"obstacles", page::json_of(page::drawn_objects(shown.scene))},
              {"newcomer", newcomer},
              {"searches", grown},
              {"samples", drawn_samples(robot, shown, distribution, run.distribution)}});
  data.pop_back();
  return data + "," + run.figures.dump().substr(1);
}

}  // namespace

PageRun parse_run(const std::string& document, models::RobotArguments robot) {
  const auto json = nlohmann::ordered_json::parse(document);
  const auto& files = json.at("files");
  const auto file = [&](const char* name) { return files.at(name).get<std::string>(); };
  robot.source = file("model");
  PageRun run{std::move(robot),         file("problems"),        file("uniform"),
              file("guided"),           file("distribution"),    file("advice"),
              file("uniform-searches"), file("guided-searches"), {},
              json.at("shown"),         json.at("figures")};
  for (const auto& teacher : json.at("teachers"))
    run.teachers.push_back({teacher.at(0).get<std::string>(), teacher.at(1).get<std::string>(),
                            teacher.at(2).get<std::string>()});
  return run;
}

void write_page(const PageRun& run, std::ostream& out) {
  const models::LoadedRobot robot = models::load_robot(run.robot).value_or_throw();
  const auto text = [](std::string_view name) { return page::text_of(page_texts(), name); };
  page::Document document;
  document.title = "Kinship: what guidance was worth to " + robot.description.label;
  document.body = text("story.html");
  document.data = data_of(run, robot);
  document.styles = {text("story.css")};
  document.scripts = {text("station.js"), text("searches.js"), text("story.js")};
  document.draws_scenes = true;
  document.draws_charts = true;
  page::write_document(document, out);
  if (!out)
    throw Failure(ErrorCode::Storage, "cannot write the page");
}

}  // namespace kinship::results
