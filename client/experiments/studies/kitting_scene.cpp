#include "client/experiments/studies/kitting_scene.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::experiments {

namespace {

// The rack: its frame lies on the table below the middle of its front, x into it.
constexpr double kRackX_m = 0.62;
constexpr double kRackWall_m = 0.015;
constexpr double kRackDepth_m = 0.25;
constexpr double kColumnWidth_m = 0.19, kRowHeight_m = 0.23;  // inside
constexpr double kFirstRow_m = 0.12;  // floor of the lower row above the table

// Where parts lie on the table.
constexpr double kPartsX_m = 0.44, kPartsHalfX_m = 0.06, kPartsHalfY_m = 0.35;
constexpr double kPickTurn_rad = std::numbers::pi / 4;
constexpr double kPartsApart_m = 0.18;  // from the one to fetch, so that a hand fits between
constexpr std::size_t kOtherParts = 3;

constexpr double kPlaceNoise_m = 0.005, kPlaceTurnNoise_rad = 0.03;  // of the part in its place
constexpr double kAboveFloor_m =
    0.05;  // the transfer frame in a compartment, above the part's half
constexpr double kPalmInside_m = 0.01;
constexpr double kPartLift_m = 0.08;
constexpr double kBelowTable_m = 0.005;

double between(std::mt19937_64& generator, double half) {
  return std::uniform_real_distribution<double>(-half, half)(generator);
}

Eigen::Isometry3d upright_at(const Eigen::Vector3d& p, double yaw_rad = 0) {
  Eigen::Isometry3d T{Eigen::Translation3d(p)};
  T.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

void add_rack(Scene& scene) {
  const double pitch_y = kColumnWidth_m + kRackWall_m, pitch_z = kRowHeight_m + kRackWall_m;
  const double width = kKittingColumns * pitch_y + kRackWall_m;
  const double bottom = kFirstRow_m - kRackWall_m;
  const double height = kKittingRows * pitch_z + kRackWall_m;
  const double x = kRackX_m + kRackDepth_m / 2;
  const auto add = [&](std::string name, const Eigen::Vector3d& size, const Eigen::Vector3d& p) {
    scene.objects.push_back({std::move(name), BoxShape{size}, upright_at(p)});
  };
  for (std::size_t row = 0; row <= kKittingRows; ++row)
    add("rack_board_" + std::to_string(row), {kRackDepth_m, width, kRackWall_m},
        {x, 0, kFirstRow_m + static_cast<double>(row) * pitch_z - kRackWall_m / 2});
  for (std::size_t side = 0; side <= kKittingColumns; ++side)
    add("rack_side_" + std::to_string(side), {kRackDepth_m, kRackWall_m, height},
        {x, (static_cast<double>(side) - kKittingColumns / 2.0) * pitch_y, bottom + height / 2});
  add("rack_back", {kRackWall_m, width, height},
      {kRackX_m + kRackDepth_m + kRackWall_m / 2, 0, bottom + height / 2});
  add("rack_plinth", {kRackDepth_m, width, bottom}, {x, 0, bottom / 2});
}

Eigen::Isometry3d T_task_pick_at(double x, double y, double yaw_rad) {
  Eigen::Isometry3d R_down = Eigen::Isometry3d::Identity();
  R_down.linear() << -1, 0, 0, 0, 1, 0, 0, 0, -1;
  const double palm = T_transfer_part().translation().z() + kitting_part().size.z() / 2;
  return upright_at({x, y, palm + kPartLift_m}, yaw_rad) * R_down;
}

/// The hand looks into the compartment.
Eigen::Isometry3d T_task_place_in(std::size_t compartment, std::mt19937_64& generator) {
  const double column = static_cast<double>(compartment % kKittingColumns);
  const std::size_t rows_below = compartment / kKittingColumns;
  const double row = static_cast<double>(rows_below);
  Eigen::Isometry3d R_forward = Eigen::Isometry3d::Identity();
  R_forward.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  Noise noise(generator);
  const double x = kRackX_m + kPalmInside_m + noise(kPlaceNoise_m);
  const double y = (column - (kKittingColumns - 1) / 2.0) * (kColumnWidth_m + kRackWall_m) +
                   noise(kPlaceNoise_m);
  const double z = kFirstRow_m + row * (kRowHeight_m + kRackWall_m) + kAboveFloor_m +
                   kitting_part().size.x() / 2;
  return upright_at({x, y, z}, noise(kPlaceTurnNoise_rad)) * R_forward;
}

/// Parts that wait, apart from the one to fetch and from each other; what finds no place is left
/// out.
void add_other_parts(const Eigen::Vector3d& pick, std::mt19937_64& generator, Scene& scene) {
  constexpr int kTries = 20;
  std::vector<Eigen::Vector2d> taken = {pick.head<2>()};
  for (std::size_t i = 0; i < kOtherParts; ++i)
    for (int tries = 0; tries < kTries; ++tries) {
      const double x = kPartsX_m + between(generator, kPartsHalfX_m);
      const double y = between(generator, kPartsHalfY_m);
      const double yaw_rad = between(generator, std::numbers::pi / 2);
      const Eigen::Vector2d spot(x, y);
      if (std::ranges::any_of(taken, [&](const Eigen::Vector2d& other) {
            return (other - spot).norm() < kPartsApart_m;
          }))
        continue;
      taken.push_back(spot);
      scene.objects.push_back({"part_" + std::to_string(i), kitting_part(),
                               upright_at({x, y, kitting_part().size.z() / 2}, yaw_rad)});
      break;
    }
}

}  // namespace

BoxShape kitting_part() { return {{0.05, 0.06, 0.1}}; }

Eigen::Isometry3d T_transfer_part() { return upright_at({0, 0, 0.07}); }

Eigen::Isometry3d T_task_nominal_pick() { return T_task_pick_at(kPartsX_m, 0, 0); }

std::size_t compartment_of(std::uint64_t seed, std::uint32_t index) {
  constexpr std::uint32_t kOrder = 0xffff'ffff;  // no draw of an instance
  constexpr std::uint32_t kRound = kKittingCompartments;
  std::mt19937_64 generator = generator_for({seed, index / kRound, kOrder}, Use::Scene);
  std::array<std::size_t, kKittingCompartments> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, generator);
  return order.at(index % kRound);
}

KittingScene draw_kitting_scene(std::size_t compartment, std::mt19937_64& generator) {
  KittingScene instance;
  const Eigen::Vector3d table(0.9, 1.4, 0.04);
  constexpr double kEdge_m = 0.2;  // before it stand the robots
  instance.scene.objects.push_back(
      {"table", BoxShape{table},
       upright_at({kEdge_m + table.x() / 2, 0, -table.z() / 2 - kBelowTable_m})});
  add_rack(instance.scene);
  const double x = kPartsX_m + between(generator, kPartsHalfX_m);
  const double y = between(generator, kPartsHalfY_m);
  instance.T_task_pick = T_task_pick_at(x, y, between(generator, kPickTurn_rad));
  instance.T_task_place = T_task_place_in(compartment, generator);
  add_other_parts(instance.T_task_pick.translation(), generator, instance.scene);
  return instance;
}

namespace {

/// Draws the instances of one robot.
class KittingInstances {
 public:
  KittingInstances(int max_goals, const models::LoadedRobot& robot, const StudyRobot& placed)
      : max_goals_(max_goals),
        robot_(robot),
        T_task_base_(placed.T_task_base),
        starts_(robot_.chain, placed.start.size() > 0 ? placed.start : find_nominal_start()) {}

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxKittingDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          "kitting", [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  Problem make_problem(const KittingScene& instance) const {
    Problem problem;
    problem.time_limit_s = kTimeLimit_s;
    problem.T_task_base = T_task_base_;
    problem.T_task_goal = instance.T_task_place;
    problem.scene = instance.scene;
    problem.attached.push_back({"part", robot_.chain.tip_link(), kitting_part(),
                                robot_.chain.T_tip_transfer() * T_transfer_part(),
                                last_links(robot_.chain)});
    return problem;
  }

  collision::CollisionWorld make_world(const Problem& problem) const {
    return {robot_.chain, robot_.shapes, {T_task_base_, problem.scene, problem.attached, {}}};
  }

  Eigen::VectorXd find_nominal_start() const {
    std::mt19937_64 generator(0);
    KittingScene empty = draw_kitting_scene(0, generator);
    std::erase_if(empty.scene.objects,
                  [](const SceneObject& object) { return object.name.starts_with("part_"); });
    collision::CollisionWorld world = make_world(make_problem(empty));
    std::optional<Eigen::VectorXd> best =
        find_middle_configuration(robot_.chain, T_task_base_.inverse() * T_task_nominal_pick(),
                                  [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!best)
      throw Failure(ErrorCode::NotFound, "robot '" + robot_.description.label +
                                             "' has no free start in 'kitting': is its placement "
                                             "right?");
    return *std::move(best);
  }

  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
    const KittingScene instance =
        draw_kitting_scene(compartment_of(key.seed, key.index), scene_generator);
    Problem problem = make_problem(instance);
    problem.name = instance_name("kitting", key);
    problem.seed = planner_seed(key);
    collision::CollisionWorld world = make_world(problem);
    const auto is_free = [&](const Eigen::VectorXd& q) { return !world.collides(q); };
    std::mt19937_64 start_generator = generator_for(key, Use::Start);
    Noise start_noise(start_generator);
    const auto start =
        starts_.draw(T_task_base_.inverse() * instance.T_task_pick, start_noise, is_free);
    const GoalPose goal{T_task_base_.inverse() * instance.T_task_place, max_goals_, problem.seed};
    if (!start || !has_free_goals(robot_.chain, goal, *start, is_free))
      return std::nullopt;
    problem.start = *start;
    return problem;
  }

  const int max_goals_;
  const models::LoadedRobot robot_;
  const Eigen::Isometry3d T_task_base_;
  const StartDraws starts_;
};

}  // namespace

DrawInstance make_kitting_instances(int max_goals, const models::LoadedRobot& robot,
                                    const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const KittingInstances>(max_goals, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
