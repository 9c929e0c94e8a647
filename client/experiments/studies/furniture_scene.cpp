#include "client/experiments/studies/furniture_scene.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::experiments {

namespace {

constexpr double kBoard_m = 0.02;        // thickness of boards, sides and backs
constexpr double kThingRadius_m = 0.06;  // from a thing's middle to a wall, at least

void add_solid(Furniture& furniture, std::string name, const Eigen::Vector3d& size,
               const Eigen::Vector3d& middle) {
  furniture.solids.push_back(
      {std::move(name), BoxShape{size}, Eigen::Isometry3d(Eigen::Translation3d(middle))});
}

/// A board, by the middle of its top.
void add_board(Furniture& furniture, const std::string& name, double depth, double width,
               const Eigen::Vector3d& top) {
  add_solid(furniture, name, {depth, width, kBoard_m}, top - Eigen::Vector3d(0, 0, kBoard_m / 2));
}

/// How a shelf is made.
struct ShelfShape {
  double width = 0, depth = 0;  ///< m, outside
  std::vector<double> floors;   ///< m, tops of the boards that things stand on, ascending
  double top = 0;               ///< m, of its uppermost board, where nothing stands
};

void add_shelf(Furniture& furniture, const ShelfShape& shape) {
  const double inside = shape.width - 2 * kBoard_m;
  std::vector<double> tops = shape.floors;
  tops.push_back(shape.top);
  for (std::size_t i = 0; i < tops.size(); ++i)
    add_board(furniture, "board_" + std::to_string(i), shape.depth, inside, {0, 0, tops[i]});
  for (const double side : {-1.0, 1.0})
    add_solid(furniture, side > 0 ? "side_left" : "side_right", {shape.depth, kBoard_m, shape.top},
              {0, side * (shape.width - kBoard_m) / 2, shape.top / 2});
  add_solid(furniture, "back", {kBoard_m, shape.width, shape.top},
            {(shape.depth + kBoard_m) / 2, 0, shape.top / 2});
  for (const double floor : shape.floors)
    furniture.boards.push_back({{0, 0, floor},
                                shape.depth / 2 - kThingRadius_m,
                                inside / 2 - kThingRadius_m,
                                Approach::Forward});
}

/// A box on a block, its lid hinged at the back and half open.
void add_box_with_lid(Furniture& furniture) {
  constexpr double kDepth = 0.40, kWidth = 0.50, kHeight = 0.28, kBlock = 0.25;
  constexpr double kOpen_rad = 60 * std::numbers::pi / 180;  // from closed
  add_solid(furniture, "block", {kDepth, kWidth, kBlock}, {0, 0, kBlock / 2});
  const double floor = kBlock + kBoard_m, middle = kBlock + kHeight / 2;
  add_board(furniture, "bottom", kDepth, kWidth, {0, 0, floor});
  for (const double side : {-1.0, 1.0}) {
    add_solid(furniture, side > 0 ? "wall_left" : "wall_right", {kDepth, kBoard_m, kHeight},
              {0, side * (kWidth - kBoard_m) / 2, middle});
    add_solid(furniture, side > 0 ? "wall_back" : "wall_front", {kBoard_m, kWidth, kHeight},
              {side * (kDepth - kBoard_m) / 2, 0, middle});
  }
  Eigen::Isometry3d T_furniture_hinge(
      Eigen::Translation3d(kDepth / 2, 0, kBlock + kHeight + kBoard_m));
  T_furniture_hinge.rotate(Eigen::AngleAxisd(kOpen_rad, Eigen::Vector3d::UnitY()));
  furniture.solids.push_back({"lid", BoxShape{{kDepth, kWidth, kBoard_m}},
                              T_furniture_hinge * Eigen::Translation3d(-kDepth / 2, 0, 0)});
  const double inset = kBoard_m + kThingRadius_m;
  furniture.boards.push_back(
      {{0, 0, floor}, kDepth / 2 - inset, kWidth / 2 - inset, Approach::Downward});
}

/// A cage of bars on a block; a hand comes in between the bars of its front.
void add_cage(Furniture& furniture) {
  constexpr double kDepth = 0.30, kWidth = 0.90, kHeight = 0.50, kBlock = 0.40;
  constexpr double kBarRadius = 0.008;
  constexpr int kFrontGaps = 3, kBackGaps = 7, kSideGaps = 4;
  add_solid(furniture, "block", {kDepth, kWidth, kBlock}, {0, 0, kBlock / 2});
  const double floor = kBlock + kBoard_m, roof = floor + kHeight + kBoard_m;
  add_board(furniture, "bottom", kDepth, kWidth, {0, 0, floor});
  add_board(furniture, "roof", kDepth, kWidth, {0, 0, roof});
  const double x = kDepth / 2 - kBarRadius, y = kWidth / 2 - kBarRadius;
  const auto add_bar = [&](double bar_x, double bar_y) {
    furniture.solids.push_back(
        {"bar_" + std::to_string(furniture.solids.size()), CylinderShape{kBarRadius, kHeight},
         Eigen::Isometry3d(Eigen::Translation3d(bar_x, bar_y, floor + kHeight / 2))});
  };
  for (int i = 0; i <= kFrontGaps; ++i)
    add_bar(-x, -y + 2 * y * i / kFrontGaps);
  for (int i = 0; i <= kBackGaps; ++i)
    add_bar(x, -y + 2 * y * i / kBackGaps);
  for (int i = 1; i < kSideGaps; ++i)
    for (const double side : {-1.0, 1.0})
      add_bar(-x + 2 * x * i / kSideGaps, side * y);
  furniture.boards.push_back(
      {{0, 0, floor}, x - kThingRadius_m, y - kThingRadius_m, Approach::Forward});
}

/// A low table; things stand on it and below it.
void add_table_with_legs(Furniture& furniture) {
  constexpr double kDepth = 0.5, kWidth = 1.0, kTop = 0.55, kLeg = 0.05;
  add_board(furniture, "top", kDepth, kWidth, {0, 0, kTop});
  const double x = (kDepth - kLeg) / 2, y = (kWidth - kLeg) / 2, height = kTop - kBoard_m;
  for (const double front : {-1.0, 1.0})
    for (const double side : {-1.0, 1.0})
      add_solid(
          furniture,
          std::string("leg_") + (front < 0 ? "front_" : "back_") + (side > 0 ? "left" : "right"),
          {kLeg, kLeg, height}, {front * x, side * y, height / 2});
  const double half_x = kDepth / 2 - kThingRadius_m, half_y = kWidth / 2 - kThingRadius_m;
  furniture.boards.push_back({{0, 0, kTop}, half_x, half_y, Approach::Downward});
  furniture.boards.push_back({{0, 0, 0}, half_x, half_y - kLeg, Approach::Forward});
}

}  // namespace

Furniture make_furniture(FurnitureKind kind) {
  Furniture furniture;
  switch (kind) {
    case FurnitureKind::Shelf:
      furniture.nominal_x = 0.85;
      furniture.things = 4;
      add_shelf(furniture, {.width = 0.9, .depth = 0.3, .floors = {0.4, 0.71}, .top = 1.02});
      break;
    case FurnitureKind::TallShelf:
      furniture.nominal_x = 0.85;
      furniture.things = 6;
      add_shelf(furniture,
                {.width = 0.8, .depth = 0.3, .floors = {0.2, 0.51, 0.82, 1.13}, .top = 1.44});
      break;
    case FurnitureKind::Box:
      furniture.nominal_x = 0.65;
      furniture.things = 1;
      add_box_with_lid(furniture);
      break;
    case FurnitureKind::Cage:
      furniture.nominal_x = 0.85;
      furniture.things = 2;
      add_cage(furniture);
      break;
    case FurnitureKind::Table:
      furniture.nominal_x = 0.75;
      furniture.things = 5;
      add_table_with_legs(furniture);
      break;
  }
  return furniture;
}

std::string_view study_name(FurnitureKind kind) {
  switch (kind) {
    case FurnitureKind::Shelf:
      return "furniture_shelf";
    case FurnitureKind::TallShelf:
      return "furniture_tall_shelf";
    case FurnitureKind::Box:
      return "furniture_box";
    case FurnitureKind::Cage:
      return "furniture_cage";
    case FurnitureKind::Table:
      break;
  }
  return "furniture_table";
}

namespace {

// The thing to grasp: a bottle from the side, a can from above.
constexpr double kTargetRadius_m = 0.03;
constexpr double kBottleHeight_m = 0.18, kBottleGrip_m = 0.11, kCanHeight_m = 0.10;
constexpr double kPalmGap_m = 0.025;  // between palm and thing; the fingers are 8 cm long
constexpr double kForwardTurn_rad = 20 * std::numbers::pi / 180;
constexpr double kDownwardTurn_rad = 45 * std::numbers::pi / 180;

constexpr double kApart_m = 0.14;     // of things on a board, middle to middle, at least
constexpr double kHover_m = 0.002;    // nothing that stands touches what it stands on
constexpr double kFloorGap_m = 0.01;  // the floor is that much below

double uniform(std::mt19937_64& generator, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator);
}

std::size_t choose(std::mt19937_64& generator, std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(generator);
}

Eigen::Isometry3d moved(const Eigen::Vector3d& p, double yaw_rad = 0) {
  Eigen::Isometry3d T{Eigen::Translation3d(p)};
  T.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

Eigen::Vector3d draw_spot(const Board& board, std::mt19937_64& generator) {
  const double x = uniform(generator, -board.half_x, board.half_x);
  const double y = uniform(generator, -board.half_y, board.half_y);
  return board.middle + Eigen::Vector3d(x, y, kHover_m);
}

/// A thing and how high its middle is above what it stands on.
std::pair<Shape, double> draw_thing(std::mt19937_64& generator) {
  switch (choose(generator, 3)) {
    case 0: {
      const double radius = uniform(generator, 0.03, 0.05), height = uniform(generator, 0.1, 0.2);
      return {CylinderShape{radius, height}, height / 2};
    }
    case 1: {
      const double width = uniform(generator, 0.06, 0.1), height = uniform(generator, 0.06, 0.2);
      return {BoxShape{{width, width, height}}, height / 2};
    }
    default: {
      const double radius = uniform(generator, 0.03, 0.05);
      return {SphereShape{radius}, radius};
    }
  }
}

/// Things on the boards, none nearer than kApart_m to another; what finds no place is left out.
void add_things(const Furniture& furniture, const Eigen::Vector3d& target,
                const Eigen::Isometry3d& T_task_furniture, std::mt19937_64& generator,
                Scene& scene) {
  constexpr int kTries = 20;
  std::vector<Eigen::Vector3d> taken = {target};
  for (std::size_t i = 0; i < furniture.things; ++i) {
    const auto [shape, height] = draw_thing(generator);
    const Board& board = furniture.boards[choose(generator, furniture.boards.size())];
    for (int tries = 0; tries < kTries; ++tries) {
      const Eigen::Vector3d spot = draw_spot(board, generator);
      const double yaw_rad = uniform(generator, 0, std::numbers::pi / 2);
      bool is_near = false;
      for (const Eigen::Vector3d& other : taken)
        is_near = is_near || (other - spot).norm() < kApart_m;
      if (is_near)
        continue;
      taken.push_back(spot);
      scene.objects.push_back(
          {"thing_" + std::to_string(i), shape,
           T_task_furniture * moved(spot + Eigen::Vector3d(0, 0, height), yaw_rad)});
      break;
    }
  }
}

/// Of the transfer frame at a thing that stands at the origin.
Eigen::Isometry3d T_spot_grasp(Approach approach, double yaw_rad) {
  Eigen::Isometry3d R = Eigen::Isometry3d::Identity();
  if (approach == Approach::Forward) {
    R.linear() << 0, 0, 1, 0, -1, 0, 1, 0, 0;
    return moved({0, 0, kBottleGrip_m}, yaw_rad) *
           Eigen::Translation3d(-kTargetRadius_m - kPalmGap_m, 0, 0) * R;
  }
  R.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return moved({0, 0, kCanHeight_m + kPalmGap_m}, yaw_rad) * R;
}

}  // namespace

FurnitureScene draw_furniture_scene(FurnitureKind kind, std::mt19937_64& generator) {
  const Furniture furniture = make_furniture(kind);
  const double x = uniform(generator, -kFurnitureShift_m, kFurnitureShift_m);
  const double y = uniform(generator, -kFurnitureShift_m, kFurnitureShift_m);
  const double yaw_rad = uniform(generator, -kFurnitureTurn_rad, kFurnitureTurn_rad);

  FurnitureScene instance;
  instance.T_task_furniture = moved({furniture.nominal_x + x, y, 0}, yaw_rad);
  instance.scene.objects.push_back(
      {kFloorName, BoxShape{{4, 4, 0.1}}, moved({0, 0, -0.05 - kFloorGap_m})});
  for (const SceneObject& solid : furniture.solids)
    instance.scene.objects.push_back(
        {solid.name, solid.shape, instance.T_task_furniture * solid.T_task_object});

  const Board& board = furniture.boards[choose(generator, furniture.boards.size())];
  const bool is_forward = board.approach == Approach::Forward;
  const Eigen::Vector3d spot = draw_spot(board, generator);
  const double height = is_forward ? kBottleHeight_m : kCanHeight_m;
  instance.scene.objects.push_back(
      {kTargetName, CylinderShape{kTargetRadius_m, height},
       instance.T_task_furniture * moved(spot + Eigen::Vector3d(0, 0, height / 2))});
  const double turn_rad = is_forward ? kForwardTurn_rad : kDownwardTurn_rad;
  instance.T_task_grasp = instance.T_task_furniture * moved(spot) *
                          T_spot_grasp(board.approach, uniform(generator, -turn_rad, turn_rad));
  add_things(furniture, spot, instance.T_task_furniture, generator, instance.scene);
  return instance;
}

namespace {

/// Draws the instances of one robot.
class FurnitureInstances {
 public:
  FurnitureInstances(FurnitureKind kind, int max_goals, models::LoadedRobot robot,
                     StudyRobot placed)
      : kind_(kind),
        max_goals_(max_goals),
        name_(study_name(kind)),
        robot_(std::move(robot)),
        placed_(std::move(placed)) {
    if (placed_.start.size() != robot_.chain.dof() || !robot_.chain.within_limits(placed_.start))
      throw Failure(ErrorCode::InvalidInput,
                    "robot '" + robot_.description.label + "' has no home in '" + name_ + "'");
  }

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxFurnitureDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          name_, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    // Each kind has random numbers of its own: no two kinds stand alike.
    constexpr std::uint64_t kSeedsOfAKind = 1'000'000;
    InstanceKey own = key;
    own.seed += kSeedsOfAKind * (static_cast<std::uint64_t>(kind_) + 1);
    std::mt19937_64 generator = generator_for(own, Use::Scene);
    const FurnitureScene instance = draw_furniture_scene(kind_, generator);
    Problem problem;
    problem.name = instance_name(name_, key);
    problem.seed = planner_seed(own);
    problem.time_limit_s = kTimeLimit_s;
    problem.T_task_base = placed_.T_task_base;
    problem.start = placed_.start;
    problem.T_task_goal = instance.T_task_grasp;
    problem.scene = instance.scene;
    for (const kinematics::ChainLink& link : robot_.chain.links())
      if (link.joint < 1)  // stands on the floor
        problem.allowed_collisions.emplace_back(link.name, kFloorName);
    collision::CollisionWorld world(
        robot_.chain, robot_.shapes,
        {problem.T_task_base.value(), problem.scene, {}, problem.allowed_collisions});
    const GoalPose goal{placed_.T_task_base.inverse() * instance.T_task_grasp, max_goals_,
                        problem.seed};
    if (world.collides(problem.start) ||
        !has_free_goals(robot_.chain, goal, problem.start,
                        [&](const Eigen::VectorXd& q) { return !world.collides(q); }))
      return std::nullopt;
    return problem;
  }

  const FurnitureKind kind_;
  const int max_goals_;
  const std::string name_;
  const models::LoadedRobot robot_;
  const StudyRobot placed_;
};

}  // namespace

DrawInstance make_furniture_instances(FurnitureKind kind, int max_goals,
                                      const models::LoadedRobot& robot, const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const FurnitureInstances>(kind, max_goals, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
