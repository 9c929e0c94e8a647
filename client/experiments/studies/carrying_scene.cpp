#include "client/experiments/studies/carrying_scene.hpp"

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::experiments {

namespace {

constexpr double kCarryingPlaceNoise_m = 0.02;
constexpr double kCarryingTurnNoise_rad = 0.04;
constexpr double kCarryingPickTurnNoise_rad = 0.06;

constexpr double kRimBelowPalm_m = 0.02;  // the fingers hold the container at its rim
constexpr double kLift_m = 0.025;         // of a carried container above the table

const Eigen::Vector3d kTableSize(0.8, 1.6, 0.04);
constexpr double kTableEdge_m = 0.2;  // before it stand the robots

/// Adds noise to a number; the argument is its standard deviation.
using Spread = std::function<double(double)>;

Eigen::Isometry3d at_height(const TablePose& pose, double z) {
  Eigen::Isometry3d T(Eigen::Translation3d(pose.x, pose.y, z));
  T.rotate(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

TablePose noisy(const TablePose& pose, double turn_noise_rad, const Spread& spread) {
  TablePose moved = pose;
  moved.x += spread(kCarryingPlaceNoise_m);
  moved.y += spread(kCarryingPlaceNoise_m);
  moved.yaw_rad += spread(turn_noise_rad);
  return moved;
}

/// A box that stands on the table or on the floor of the bin.
void add_standing(Scene& scene, std::string name, const Eigen::Vector3d& size,
                  const Eigen::Isometry3d& T_task_floor) {
  scene.objects.push_back(
      {std::move(name), BoxShape{size}, T_task_floor * Eigen::Translation3d(0, 0, size.z() / 2)});
}

void add_bin(Scene& scene, const Bin& bin, const Eigen::Isometry3d& T_task_bin) {
  const double length = bin.length_m + 2 * bin.wall_m;
  const double x = (bin.length_m + bin.wall_m) / 2, y = (bin.width_m + bin.wall_m) / 2;
  const auto add_wall = [&](const char* name, double wall_x, double wall_y, double size_x,
                            double size_y) {
    add_standing(scene, name, {size_x, size_y, bin.height_m},
                 T_task_bin * Eigen::Translation3d(wall_x, wall_y, 0));
  };
  add_wall("bin_left", 0, y, length, bin.wall_m);
  add_wall("bin_right", 0, -y, length, bin.wall_m);
  add_wall("bin_back", x, 0, bin.wall_m, bin.width_m);
  add_wall("bin_front", -x, 0, bin.wall_m, bin.width_m);
}

/// \param taken  the place, 0 or 1, that another container has in a bin.
CarryingScene make_scene(const CarryingLayout& layout, const Spread& spread, std::size_t taken) {
  CarryingScene instance;
  constexpr double kBelow_m = 0.005;  // nothing that stands on the table touches it
  instance.scene.objects.push_back(
      {"table", BoxShape{kTableSize},
       Eigen::Isometry3d(Eigen::Translation3d(kTableEdge_m + kTableSize.x() / 2, 0,
                                              -kTableSize.z() / 2 - kBelow_m))});
  const Eigen::Isometry3d T_task_middle =
      at_height(noisy(layout.place, kCarryingTurnNoise_rad, spread), 0);
  const std::array<double, 2> places = {-layout.between_places_m / 2, layout.between_places_m / 2};
  const auto T_task_place = [&](std::size_t place, double z) -> Eigen::Isometry3d {
    return T_task_middle * Eigen::Translation3d(places.at(place), 0, z);
  };
  if (layout.bin) {
    add_bin(instance.scene, *layout.bin, T_task_middle);
    add_standing(instance.scene, "other_container", layout.container, T_task_place(taken, 0));
  }
  for (const TableObject& object : layout.objects)
    add_standing(instance.scene, object.name, object.size,
                 at_height(noisy(object.pose, kCarryingTurnNoise_rad, spread), 0));

  const Eigen::AngleAxisd down(std::numbers::pi, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd half_turn(std::numbers::pi, Eigen::Vector3d::UnitZ());
  const double palm = kLift_m + layout.container.z() + kRimBelowPalm_m;
  instance.T_task_pick =
      at_height(noisy(layout.pick, kCarryingPickTurnNoise_rad, spread), palm) * down;
  const Eigen::Isometry3d T_task_goal = T_task_place(1 - taken, palm);
  instance.T_task_places = {T_task_goal * down, T_task_goal * half_turn * down};
  return instance;
}

}  // namespace

CarryingScene draw_carrying_scene(const CarryingLayout& layout, std::mt19937_64& generator) {
  std::uniform_int_distribution<std::size_t> coin(0, 1);
  const std::size_t taken = coin(generator);
  Noise noise(generator);
  return make_scene(layout, std::ref(noise), taken);
}

CarryingScene nominal_carrying_scene(const CarryingLayout& layout) {
  return make_scene(
      layout, [](double) { return 0.0; }, 0);
}

Eigen::Isometry3d T_transfer_container(const CarryingLayout& layout) {
  return Eigen::Isometry3d(Eigen::Translation3d(0, 0, kRimBelowPalm_m + layout.container.z() / 2));
}

namespace {

/// Draws the instances of one robot.
class CarryingInstances {
 public:
  CarryingInstances(CarryingLayout layout, const models::LoadedRobot& robot,
                    const StudyRobot& placed)
      : layout_(std::move(layout)),
        robot_(robot),
        T_task_base_(placed.T_task_base),
        starts_(robot_.chain, placed.start.size() > 0 ? placed.start : find_nominal_start()) {}

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxCarryingDraws,
                          "robot '" + robot_.description.label + "' has no free start and goals in",
                          layout_.name, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  Problem make_problem(const CarryingScene& instance) const {
    Problem problem;
    problem.T_task_base = T_task_base_;
    problem.time_limit_s = kTimeLimit_s;
    problem.scene = instance.scene;
    problem.constraint = planning::upright_region(layout_.tilt_rad);
    AttachedObject container{"container", robot_.chain.tip_link(), BoxShape{layout_.container},
                             robot_.chain.T_tip_transfer() * T_transfer_container(layout_),
                             last_links(robot_.chain)};
    problem.attached.push_back(std::move(container));
    return problem;
  }

  collision::CollisionWorld make_world(const Problem& problem) const {
    return {robot_.chain,
            robot_.shapes,
            {T_task_base_, problem.scene, problem.attached, problem.allowed_collisions}};
  }

  Eigen::VectorXd find_nominal_start() const {
    const CarryingScene nominal = nominal_carrying_scene(layout_);
    collision::CollisionWorld world = make_world(make_problem(nominal));
    std::optional<Eigen::VectorXd> best =
        find_middle_configuration(robot_.chain, T_task_base_.inverse() * nominal.T_task_pick,
                                  [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!best)
      throw Failure(ErrorCode::NotFound, "robot '" + robot_.description.label +
                                             "' has no free start in '" + layout_.name +
                                             "': is its placement right?");
    return *std::move(best);
  }

  /// Free configurations where a plan from the start may go: dof x n.
  Eigen::MatrixXd find_goals(const CarryingScene& instance, const Problem& problem,
                             collision::CollisionWorld& world) const {
    const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot_.chain, problem.start);
    planning::GoalOptions options;
    options.max_configurations = 2 * layout_.goal_branches;
    options.min_distance = 0.5;
    std::vector<Eigen::MatrixXd> ways;
    for (const Eigen::Isometry3d& T_task_place : instance.T_task_places) {
      options.seed = problem.seed + ways.size();
      ways.push_back(planning::goal_configurations(
                         robot_.chain, T_task_base_.inverse() * T_task_place, bounds,
                         [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options)
                         .configurations);
    }
    Eigen::MatrixXd goals(robot_.chain.dof(), layout_.goal_branches);
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < options.max_configurations; ++i)
      for (const Eigen::MatrixXd& way : ways)
        if (i < way.cols() && count < goals.cols())
          goals.col(count++) = way.col(i);
    return goals.leftCols(count);
  }

  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
    const CarryingScene instance = draw_carrying_scene(layout_, scene_generator);
    Problem problem = make_problem(instance);
    problem.name = instance_name(layout_.name, key);
    problem.seed = planner_seed(key);
    collision::CollisionWorld world = make_world(problem);
    std::mt19937_64 start_generator = generator_for(key, Use::Start);
    Noise start_noise(start_generator);
    const auto start = starts_.draw(T_task_base_.inverse() * instance.T_task_pick, start_noise,
                                    [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!start)
      return std::nullopt;
    problem.start = *start;
    problem.goal_configurations = find_goals(instance, problem, world);
    if (problem.goal_configurations.cols() < layout_.least_goal_branches)
      return std::nullopt;
    return problem;
  }

  const CarryingLayout layout_;
  const models::LoadedRobot robot_;
  const Eigen::Isometry3d T_task_base_;
  const StartDraws starts_;
};

}  // namespace

DrawInstance make_carrying_instances(const CarryingLayout& layout, const models::LoadedRobot& robot,
                                     const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const CarryingInstances>(layout, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
