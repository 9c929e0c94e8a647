#include "client/experiments/studies/furniture_kinds.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "proto/types/failure.hpp"

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

}  // namespace kinship::experiments
