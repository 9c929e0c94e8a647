#include "client/experiments/studies/furniture_scene.hpp"

#include <string>
#include <utility>

namespace kinship::experiments {
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

}  // namespace kinship::experiments
