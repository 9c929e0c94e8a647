#include "tests/bench/season_tasks.hpp"

#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "client/planning/goal_configurations.hpp"
#include "client/planning/planning_bounds.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kNominal = ~std::uint64_t{0};  // the query without noise

/// A box in the plane: centre, half extents (m), direction (rad).
struct PlanarBox {
  double x, y, half_x, half_y, angle;
};

/// A planar arm carries a box of 6 x 8 cm from a pose (x, y, yaw) to another.
struct PlanarScene {
  std::string robot;
  std::vector<PlanarBox> boxes;
  Eigen::Vector3d start, goal;
  int goal_branches = 8;
};

/// Free configurations for a pose.
Eigen::MatrixXd free_branches(const kinematics::Chain& chain, collision::CollisionWorld& world,
                              const Eigen::Isometry3d& T_base_goal, const Eigen::VectorXd& around,
                              const planning::GoalOptions& options) {
  return planning::goal_configurations(
             chain, T_base_goal, planning::planning_bounds(chain, around),
             [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options)
      .configurations;
}

Eigen::VectorXd middle_of(const kinematics::Chain& chain) {
  Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  return middle.allFinite() ? middle : Eigen::VectorXd::Zero(chain.dof());
}

/// A configuration near another one, or nothing if none is free.
std::optional<Eigen::VectorXd> noisy(const Eigen::VectorXd& q, const kinematics::Chain& chain,
                                     collision::CollisionWorld& world, std::mt19937_64& generator) {
  constexpr double kNoise_rad = 0.1;
  constexpr int kTries = 20;
  std::normal_distribution<double> normal(0, kNoise_rad);
  for (int i = 0; i < kTries; ++i) {
    Eigen::VectorXd near = q;
    for (double& joint : near)
      joint += normal(generator);
    const bool within = (near.array() >= chain.lower().array()).all() &&
                        (near.array() <= chain.upper().array()).all();
    if (within && !world.collides(near))
      return near;
  }
  return std::nullopt;
}

class PlanarTask final : public SeasonTask {
 public:
  PlanarTask(const std::string& task, PlanarScene scene)
      : SeasonTask(task, scene.robot, {0.05, 2, 30'000}), scene_(std::move(scene)) {
    std::mt19937_64 generator(0);
    collision::CollisionWorld world(chain, shapes, surroundings(generator, 0));
    const Eigen::MatrixXd starts =
        free_branches(chain, world, pose_near(scene_.start, generator, 0, 0), middle_of(chain),
                      {.max_configurations = 60, .min_distance = 0.1, .seed = 1});
    if (starts.cols() == 0)
      throw std::invalid_argument(task + ": no start configuration");
    Eigen::Index best = 0;
    starts.colwise().squaredNorm().minCoeff(&best);
    start_ = starts.col(best);
  }

  std::optional<SeasonQuery> make_query(std::uint64_t number) const override {
    constexpr double kBox_m = 0.02, kGoal_m = 0.01, kGoal_rad = 0.04;
    std::mt19937_64 generator(number);
    collision::CollisionWorld world(chain, shapes, surroundings(generator, kBox_m));
    const Eigen::Isometry3d T_base_goal = pose_near(scene_.goal, generator, kGoal_m, kGoal_rad);
    auto start = noisy(start_, chain, world, generator);
    if (!start)
      return std::nullopt;
    Eigen::MatrixXd goals = free_branches(
        chain, world, T_base_goal, *start,
        {.max_configurations = scene_.goal_branches, .min_distance = 0.5, .seed = number});
    if (goals.cols() == 0)
      return std::nullopt;
    return SeasonQuery{std::move(world), *std::move(start), std::move(goals)};
  }

 private:
  /// Obstacles move by `noise_m` and turn by twice as many rad.
  collision::Surroundings surroundings(std::mt19937_64& generator, double noise_m) const {
    std::normal_distribution<double> normal;
    collision::Surroundings around;
    for (const PlanarBox& box : scene_.boxes) {
      const double x = box.x + noise_m * normal(generator);
      const double y = box.y + noise_m * normal(generator);
      around.scene.objects.push_back(
          {"box" + std::to_string(around.scene.objects.size()),
           BoxShape{{2 * box.half_x, 2 * box.half_y, 0.1}},
           test::planar_pose(x, y, box.angle + 2 * noise_m * normal(generator))});
    }
    AttachedObject held;
    held.name = "held";
    held.link = chain.tip_link();
    held.shape = BoxShape{{0.06, 0.08, 0.02}};
    held.touch_links = {"link_" + std::to_string(chain.dof()),
                        "link_" + std::to_string(chain.dof() - 1)};
    around.attached.push_back(held);
    return around;
  }

  static Eigen::Isometry3d pose_near(const Eigen::Vector3d& pose, std::mt19937_64& generator,
                                     double noise_m, double noise_rad) {
    std::normal_distribution<double> normal;
    const double x = pose.x() + noise_m * normal(generator);
    const double y = pose.y() + noise_m * normal(generator);
    return test::planar_pose(x, y, pose.z() + noise_rad * normal(generator));
  }

  PlanarScene scene_;
  Eigen::VectorXd start_;  // without noise
};

/// A cobot in the shelf cell of planning_bench, or the same motion over an empty table.
class CobotTask final : public SeasonTask {
 public:
  CobotTask(const std::string& task, const std::string& robot, bool is_open)
      : SeasonTask(task, robot, {0.05, 1.5, 30'000}), is_open_(is_open) {
    std::mt19937_64 generator(kNominal);
    const ShelfCell cell = make_cell(generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::MatrixXd starts =
        free_branches(chain, world, cell.T_base_start, middle_of(chain), {});
    if (starts.cols() == 0)
      throw std::invalid_argument(task + ": no start configuration");
    Eigen::Index best = 0;
    (starts.colwise() - middle_of(chain)).colwise().squaredNorm().minCoeff(&best);
    start_ = starts.col(best);
  }

  std::optional<SeasonQuery> make_query(std::uint64_t number) const override {
    std::mt19937_64 generator(number);
    const ShelfCell cell = make_cell(generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    auto start = noisy(start_, chain, world, generator);
    if (!start)
      return std::nullopt;
    Eigen::MatrixXd goals = free_branches(chain, world, cell.T_base_goal, *start, {.seed = number});
    if (goals.cols() == 0)
      return std::nullopt;
    return SeasonQuery{std::move(world), *std::move(start), std::move(goals)};
  }

 private:
  ShelfCell make_cell(std::mt19937_64& generator) const {
    ShelfCell cell = make_shelf_cell(chain, generator);
    if (is_open_) {
      cell.surroundings.scene.objects.resize(1);  // the table
      cell.T_base_goal = cell.T_base_start;       // palm down on the other side
      cell.T_base_goal.translation().y() = -0.4;
    }
    return cell;
  }

  bool is_open_;
  Eigen::VectorXd start_;
};

const std::vector<std::pair<std::string, PlanarScene>>& planar_scenes() {
  static const std::vector<std::pair<std::string, PlanarScene>> scenes = {
      {"pocket",
       {"planar_5r_b",
        {{0.62, 0.105, 0.2, 0.04, 0}, {0.62, -0.105, 0.2, 0.04, 0}, {0.30, 0.42, 0.12, 0.05, -0.6}},
        {0.12, 0.72, 1.3},
        {0.62, 0, 0},
        8}},
      {"slot",
       {"planar_5r_b",
        {{0.65, 0.12, 0.2, 0.05, 0}, {0.65, -0.12, 0.2, 0.05, 0}, {0.05, 0.45, 0.05, 0.15, 0.2}},
        {-0.35, 0.5, 2.2},
        {0.62, 0, 0},
        8}},
      {"trivial",
       {"planar_5r_b",
        {{0.7, 0, 0.2, 0.03, 0}, {0.7, 0.46, 0.2, 0.03, 0}, {0.7, -0.46, 0.2, 0.03, 0}},
        {0.65, 0.23, 0},
        {0.65, -0.23, 0},
        20}}};
  return scenes;
}

}  // namespace

SeasonTask::SeasonTask(std::string task, const std::string& robot, const SeasonPlanner& how)
    : name(std::move(task)),
      chain(test::model_chain(robot)),
      shapes(model_shapes(robot)),
      planner(how) {}

std::vector<std::string> season_task_names() {
  return {"pocket", "slot", "trivial", "shelf", "table"};
}

std::unique_ptr<SeasonTask> make_season_task(const std::string& name) {
  for (const auto& [task, scene] : planar_scenes())
    if (task == name)
      return std::make_unique<PlanarTask>(name, scene);
  if (name == "shelf")
    return std::make_unique<CobotTask>(name, "panda", false);
  if (name == "table")
    return std::make_unique<CobotTask>(name, "ur10e", true);
  throw std::invalid_argument("no season task named '" + name + "'");
}

}  // namespace kinship::bench
