#include "client/experiments/studies/dear_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <utility>

#include "client/experiments/studies/furniture_scene.hpp"

namespace kinship::experiments {

namespace {

constexpr double kPlank_m = 0.02;  // thickness of boards, sides and backs

/// Measures of furniture: uniform random numbers.
class Measures {
 public:
  explicit Measures(std::mt19937_64& generator) : generator_(generator) {}

  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(generator_);
  }
  double within(double half) { return between(-half, half); }
  int among(int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(generator_);
  }
  double side() { return among(0, 1) == 0 ? -1 : 1; }

 private:
  std::mt19937_64& generator_;
};

/// Furniture in its own frame: origin on the floor below the middle of its front, x into it, y to
/// the left, z up.
struct DearFurniture {
  std::vector<SceneObject> solids;
  Eigen::Isometry3d T_furniture_goal = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  std::optional<Eigen::Isometry3d> T_furniture_start = {};             ///< of it
  std::vector<HeldPart> held;

  void add(std::string name, const Eigen::Vector3d& size, const Eigen::Vector3d& middle) {
    solids.push_back(
        {std::move(name), BoxShape{size}, Eigen::Isometry3d(Eigen::Translation3d(middle))});
  }
  void add_rod(std::string name, double radius_m, const Eigen::Vector3d& from,
               const Eigen::Vector3d& to) {
    Eigen::Isometry3d T(Eigen::Translation3d((from + to) / 2));
    T.rotate(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from));
    solids.push_back({std::move(name), CapsuleShape{radius_m, (to - from).norm()}, T});
  }
  void hold(std::string name, const Eigen::Vector3d& size, const Eigen::Vector3d& middle) {
    held.push_back(
        {std::move(name), BoxShape{size}, Eigen::Isometry3d(Eigen::Translation3d(middle))});
  }
};

/// A pose of the transfer frame.
/// \param approach, closing  its z and y, the second made square to the first.
Eigen::Isometry3d hand_at(const Eigen::Vector3d& p, const Eigen::Vector3d& approach,
                          const Eigen::Vector3d& closing) {
  const Eigen::Vector3d z = approach.normalized(), y = (closing - closing.dot(z) * z).normalized();
  Eigen::Isometry3d T(Eigen::Translation3d{p});
  T.linear() << y.cross(z), y, z;
  return T;
}

/// Level but for `pitch_rad` downward, turned to the left.
Eigen::Vector3d heading(double yaw_rad, double pitch_rad = 0) {
  return {std::cos(yaw_rad) * std::cos(pitch_rad), std::sin(yaw_rad) * std::cos(pitch_rad),
          -std::sin(pitch_rad)};
}

/// A bottle to grasp, its foot at `foot`; the hand comes level.
void stand_bottle(DearFurniture& furniture, const Eigen::Vector3d& foot, double yaw_rad) {
  constexpr double kRadius_m = 0.03, kHeight_m = 0.16, kPalm_m = 0.06, kGrip_m = 0.11;
  furniture.solids.push_back(
      {kTargetName, CylinderShape{kRadius_m, kHeight_m},
       Eigen::Isometry3d(Eigen::Translation3d(foot + Eigen::Vector3d(0, 0, kHeight_m / 2)))});
  const Eigen::Vector3d approach = heading(yaw_rad);
  furniture.T_furniture_goal = hand_at(foot + Eigen::Vector3d(0, 0, kGrip_m) - kPalm_m * approach,
                                       approach, {-approach.y(), approach.x(), 0});
}

/// Bars all around on a block; a hand comes in between those of the front, in half of the cages
/// below a crossbar.
DearFurniture make_lift_cage(Measures& measures) {
  constexpr double kBar_m = 0.008;
  DearFurniture cage;
  const double width = measures.between(0.55, 0.85), depth = measures.between(0.36, 0.5);
  const double height = measures.between(0.36, 0.46), block = measures.between(0.45, 1.0);
  cage.add("block", {depth, width, block}, {depth / 2, 0, block / 2});
  cage.add("roof", {depth, width, kPlank_m}, {depth / 2, 0, block + height + kPlank_m / 2});
  int bars = 0;
  const auto add_bars = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, int gaps) {
    for (int i = 0; i <= gaps; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / gaps;
      cage.add_rod("bar_" + std::to_string(bars++), kBar_m, {at.x(), at.y(), block},
                   {at.x(), at.y(), block + height});
    }
  };
  const double x = depth - kBar_m, y = width / 2 - kBar_m;
  const int gaps = static_cast<int>(2 * y / measures.between(0.155, 0.175));
  add_bars({kBar_m, -y}, {kBar_m, y}, gaps);
  add_bars({x, -y}, {x, y}, 7);
  add_bars({kBar_m, -y}, {x, -y}, 4);
  add_bars({kBar_m, y}, {x, y}, 4);
  if (measures.side() > 0)
    cage.add_rod("crossbar", kBar_m, {kBar_m, -y, block + 0.7 * height},
                 {kBar_m, y, block + 0.7 * height});
  const double gap = 2 * y / gaps;
  const double into = -y + (measures.among(0, gaps - 1) + 0.5) * gap;
  stand_bottle(cage, {measures.between(0.26, depth - 0.08), into + measures.within(0.02), block},
               measures.within(0.3));
  return cage;
}

/// What differs between kinds of shelves, m.
struct CompartmentSizes {
  double lowest = 0, highest = 0;  ///< of the lowest board, least and most
  double width = 0, height = 0;    ///< of a compartment, at least
};

/// Two or three columns and rows; the bottle stands in one of the compartments.
DearFurniture make_compartments(Measures& measures, const CompartmentSizes& sizes) {
  DearFurniture shelf;
  const int columns = measures.among(2, 3), rows = measures.among(2, 3);
  const double depth = measures.between(0.4, 0.5);
  const double bottom = measures.between(sizes.lowest, sizes.highest);
  const double width = measures.between(sizes.width, sizes.width + 0.05);
  const double height = measures.between(sizes.height, sizes.height + 0.05);
  const double pitch_y = width + kPlank_m, pitch_z = height + kPlank_m;
  const double total_y = columns * pitch_y + kPlank_m, total_z = rows * pitch_z + kPlank_m;
  for (int row = 0; row <= rows; ++row)
    shelf.add("board_" + std::to_string(row), {depth, total_y, kPlank_m},
              {depth / 2, 0, bottom + row * pitch_z - kPlank_m / 2});
  for (int side = 0; side <= columns; ++side)
    shelf.add("side_" + std::to_string(side), {depth, kPlank_m, total_z},
              {depth / 2, (side - columns / 2.0) * pitch_y, bottom + total_z / 2 - kPlank_m});
  shelf.add("back", {kPlank_m, total_y, total_z},
            {depth + kPlank_m / 2, 0, bottom + total_z / 2 - kPlank_m});
  const int column = measures.among(0, columns - 1), row = measures.among(0, rows - 1);
  const double y = (column - (columns - 1) / 2.0) * pitch_y;
  stand_bottle(shelf,
               {measures.between(0.26, depth - 0.06), y + measures.within(width / 2 - 0.09),
                bottom + row * pitch_z},
               measures.within(0.25));
  return shelf;
}

/// A window in a wall: its middle and its size.
struct Opening {
  double z = 0, width = 0, height = 0, thick = 0;
};

/// A wall at the front, around its window.
void add_wall(DearFurniture& furniture, const Opening& opening) {
  constexpr double kWallWidth_m = 1.8, kWallTop_m = 1.8;
  const double low = opening.z - opening.height / 2, high = opening.z + opening.height / 2;
  const double beside = (kWallWidth_m - opening.width) / 2, x = opening.thick / 2;
  furniture.add("wall_below", {opening.thick, kWallWidth_m, low}, {x, 0, low / 2});
  furniture.add("wall_above", {opening.thick, kWallWidth_m, kWallTop_m - high},
                {x, 0, (kWallTop_m + high) / 2});
  for (const double side : {-1.0, 1.0})
    furniture.add(side > 0 ? "wall_left" : "wall_right", {opening.thick, beside, opening.height},
                  {x, side * (opening.width + beside) / 2, opening.z});
}

/// A rod with a head across its end reaches through a window and looks aside behind it.
DearFurniture make_window(Measures& measures) {
  DearFurniture window;
  const Opening opening{measures.between(0.7, 0.95), measures.between(0.19, 0.23),
                        measures.between(0.19, 0.23), measures.between(0.15, 0.3)};
  add_wall(window, opening);
  constexpr double kRod_m = 0.03;
  const double length = measures.between(0.2, 0.3), head = measures.between(0.13, 0.17);
  window.hold("rod", {kRod_m, kRod_m, length}, {0, 0, length / 2 + 0.005});
  window.hold("head", {kRod_m, head, kRod_m}, {0, 0, length});
  const Eigen::Vector3d approach = heading(measures.within(0.3), measures.within(0.3));
  const Eigen::Vector3d palm(opening.thick + measures.between(-0.06, 0.04), measures.within(0.04),
                             opening.z + measures.within(0.04));
  const double roll_rad = measures.within(std::numbers::pi / 2);
  window.T_furniture_goal = hand_at(palm, approach, {0, std::cos(roll_rad), std::sin(roll_rad)});
  return window;
}

/// A gun grips the flange of an upright frame, one jaw before it and one behind.
DearFurniture make_gun(Measures& measures) {
  DearFurniture frame;
  const double width = measures.between(0.75, 1.0), height = measures.between(0.7, 0.9);
  const double low = measures.between(0.3, 0.5), thick = measures.between(0.02, 0.04);
  const double flange = measures.between(0.14, 0.2);
  const double middle = low + height / 2;
  for (const double side : {-1.0, 1.0}) {
    frame.add(side > 0 ? "bar_high" : "bar_low", {thick, width, flange},
              {0, 0, middle + side * (height - flange) / 2});
    frame.add(side > 0 ? "post_left" : "post_right", {thick, flange, height - 2 * flange},
              {0, side * (width - flange) / 2, middle});
  }
  if (measures.side() > 0)
    frame.add("pillar", {thick, 0.04, height - 2 * flange},
              {0, measures.within(width / 6), middle});
  frame.add("panel", {thick, width, height}, {measures.between(0.13, 0.18), 0, middle});
  constexpr double kArm_m = 0.03, kBody_m = 0.08, kSlack_m = 0.015;
  const double throat = flange + measures.between(0, 0.06), gap = thick + 2 * kSlack_m;
  const double across = gap + 2 * kArm_m;
  frame.hold("gun_body", {across, kArm_m, kBody_m}, {0, 0, 0.005 + kBody_m / 2});
  for (const double side : {-1.0, 1.0})
    frame.hold(side > 0 ? "jaw_left" : "jaw_right", {kArm_m, kArm_m, throat},
               {side * (gap + kArm_m) / 2, 0, 0.005 + kBody_m + throat / 2});
  // Jaws lie along the frame's plane, towards the flange from inside the frame or outside.
  const auto draw_spot = [&](int bar) {
    const bool is_post = bar < 2;
    const double out = bar % 2 == 0 ? -1 : 1;  // from the opening to the flange
    const double along = measures.within((is_post ? height : width) / 2 - flange - 0.1);
    const double aside = out * ((is_post ? width : height) - flange) / 2;
    const Eigen::Vector3d spot(0, is_post ? aside : along, middle + (is_post ? along : aside));
    const Eigen::Vector3d outward(0, is_post ? out : 0, is_post ? 0 : out);
    const double tilt_rad = measures.within(0.1);
    const Eigen::Vector3d approach = std::cos(tilt_rad) * measures.side() * outward +
                                     std::sin(tilt_rad) * Eigen::Vector3d::UnitX();
    const double reach = 0.005 + kBody_m + throat - flange / 2 + measures.between(0, 0.02);
    return hand_at(spot - reach * approach, approach,
                   measures.side() * outward.cross(Eigen::Vector3d::UnitX()));
  };
  const int first = measures.among(0, 3);
  frame.T_furniture_start = draw_spot(first);
  frame.T_furniture_goal = draw_spot((first + measures.among(1, 3)) % 4);
  return frame;
}

/// How bins are made that stand side by side.
struct BinShape {
  double depth = 0, width = 0, height = 0, stand = 0;  ///< m, outside
  double gripper = 0;                                  ///< m, length
};

/// A deep bin whose lid leaves a mouth.
/// \param y  of its middle.
/// \return  of the hand whose gripper ends above its bottom.
Eigen::Isometry3d add_bin(DearFurniture& furniture, const BinShape& shape, double y,
                          Measures& measures) {
  const std::string name = y > 0 ? "left_" : "right_";
  const double top = shape.stand + shape.height, middle = shape.stand + shape.height / 2;
  const auto add = [&](const char* part, const Eigen::Vector3d& size, double part_x, double part_y,
                       double part_z) {
    furniture.add(name + part, size, {part_x, y + part_y, part_z});
  };
  add("stand", {shape.depth, shape.width, shape.stand}, shape.depth / 2, 0, shape.stand / 2);
  for (const double side : {-1.0, 1.0}) {
    add(side > 0 ? "left" : "right", {shape.depth, kPlank_m, shape.height}, shape.depth / 2,
        side * (shape.width - kPlank_m) / 2, middle);
    add(side > 0 ? "back" : "front", {kPlank_m, shape.width, shape.height},
        side > 0 ? shape.depth - kPlank_m / 2 : kPlank_m / 2, 0, middle);
  }
  const double mouth_x = measures.between(0.19, 0.22), mouth_y = measures.between(0.19, 0.22);
  const Eigen::Vector2d mouth(shape.depth / 2 + measures.within(0.05), measures.within(0.05));
  const double before = mouth.x() - mouth_x / 2, behind = shape.depth - before - mouth_x;
  add("lid_front", {before, shape.width, kPlank_m}, before / 2, 0, top + kPlank_m / 2);
  add("lid_back", {behind, shape.width, kPlank_m}, shape.depth - behind / 2, 0, top + kPlank_m / 2);
  for (const double side : {-1.0, 1.0}) {
    const double beside = shape.width / 2 - side * mouth.y() - mouth_y / 2;
    add(side > 0 ? "lid_left" : "lid_right", {mouth_x, beside, kPlank_m}, mouth.x(),
        side * (shape.width - beside) / 2, top + kPlank_m / 2);
  }
  const Eigen::Vector3d end(mouth.x() + measures.within(0.06),
                            y + mouth.y() + measures.within(0.06),
                            shape.stand + measures.between(0.02, 0.06));
  const Eigen::Vector3d approach = end - Eigen::Vector3d(mouth.x(), y + mouth.y(), top);
  return hand_at(end - shape.gripper * approach.normalized(), approach,
                 heading(measures.within(std::numbers::pi / 2)));
}

/// From one deep bin into another.
DearFurniture make_bins(Measures& measures) {
  DearFurniture bins;
  const BinShape shape{measures.between(0.36, 0.5), measures.between(0.36, 0.48),
                       measures.between(0.48, 0.58), measures.between(0.02, 0.08),
                       measures.between(0.24, 0.3)};
  bins.hold("gripper", {0.07, 0.14, shape.gripper}, {0, 0, 0.005 + shape.gripper / 2});
  const double aside = measures.side() * (shape.width / 2 + 0.01);
  bins.T_furniture_start = add_bin(bins, shape, -aside, measures);
  bins.T_furniture_goal = add_bin(bins, shape, aside, measures);
  return bins;
}

/// A vessel that hangs from the hand goes through a window and stands behind it.
DearFurniture make_upright(Measures& measures) {
  DearFurniture window;
  const Opening opening{measures.between(0.75, 0.9), measures.between(0.3, 0.38),
                        measures.between(0.47, 0.55), 0.04};
  add_wall(window, opening);
  const double side = measures.between(0.08, 0.12), height = measures.between(0.1, 0.16);
  window.hold("vessel", {side, side, height}, {0, 0, 0.03 + height / 2});
  const double floor = opening.z - opening.height / 2 - measures.between(0, 0.08);
  window.add("table", {0.5, 1.0, kPlank_m}, {0.32, 0, floor - kPlank_m / 2});
  window.T_furniture_start =
      hand_at({-measures.between(0.2, 0.3), measures.within(0.3), opening.z + measures.within(0.2)},
              -Eigen::Vector3d::UnitZ(), heading(measures.within(1.2)));
  window.T_furniture_goal =
      hand_at({measures.between(0.24, 0.34), measures.within(0.14), floor + 0.05 + height},
              -Eigen::Vector3d::UnitZ(), heading(measures.within(1.2)));
  return window;
}

/// Another arm: foot, upper arm, forearm, hand. Its hand is before the front of the furniture, near
/// the goal.
void add_other_arm(Measures& measures, DearFurniture& furniture) {
  constexpr double kUpper_m = 0.45, kFore_m = 0.45;
  const double aside = measures.side();
  const Eigen::Vector3d shoulder(-measures.between(0.2, 0.5), aside * measures.between(0.5, 0.75),
                                 measures.between(0.6, 0.8));
  const Eigen::Vector3d goal = furniture.T_furniture_goal.translation();
  Eigen::Vector3d hand(-measures.between(0.06, 0.16),
                       goal.y() + aside * measures.between(0.15, 0.3),
                       goal.z() + measures.within(0.2));
  const Eigen::Vector3d reach = hand - shoulder;
  const double distance = std::min(reach.norm(), 0.95 * (kUpper_m + kFore_m));
  hand = shoulder + distance * reach.normalized();
  const double angle_rad = measures.within(1.2);  // of the elbow about the line to the hand
  const Eigen::Vector3d level = reach.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d up = level.cross(reach).normalized();
  const double half = distance / 2, bend = std::sqrt(kUpper_m * kUpper_m - half * half);
  const Eigen::Vector3d elbow =
      (shoulder + hand) / 2 + bend * (std::cos(angle_rad) * up + std::sin(angle_rad) * level);
  furniture.add_rod("other_foot", 0.09, {shoulder.x(), shoulder.y(), 0.09}, shoulder);
  furniture.add_rod("other_upper", 0.07, shoulder, elbow);
  furniture.add_rod("other_forearm", 0.06, elbow, hand);
  furniture.add("other_hand", {0.16, 0.08, 0.08}, hand + Eigen::Vector3d(0.06, 0, 0));
}

DearFurniture make_dear_furniture(DearKind kind, Measures& measures) {
  switch (kind) {
    case DearKind::LiftCage:
      return make_lift_cage(measures);
    case DearKind::LiftShelf:
      return make_compartments(measures, {0.3, 0.7, 0.21, 0.2});
    case DearKind::Window:
      return make_window(measures);
    case DearKind::Gun:
      return make_gun(measures);
    case DearKind::Bin:
      return make_bins(measures);
    case DearKind::Upright:
      return make_upright(measures);
    case DearKind::Cloud:
      return make_compartments(measures, {0.3, 0.5, 0.25, 0.24});
    case DearKind::Beside:
      break;
  }
  DearFurniture shelf = make_compartments(measures, {0.3, 0.5, 0.21, 0.2});
  add_other_arm(measures, shelf);
  return shelf;
}

/// How far the front stands before the robots, m.
double nominal_x(DearKind kind) {
  switch (kind) {
    case DearKind::Bin:
      return 0.4;
    case DearKind::Gun:
    case DearKind::Window:
      return 0.75;
    case DearKind::Upright:
      return 0.52;
    default:
      return 0.65;
  }
}

}  // namespace

std::string_view study_name(DearKind kind) {
  static constexpr std::array<std::string_view, 8> kNames = {
      "dear_lift_cage", "dear_lift_shelf", "dear_window", "dear_gun",
      "dear_bin",       "dear_upright",    "dear_cloud",  "dear_beside"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Eigen::Matrix3Xd voxels_in(const std::vector<SceneObject>& solids, double voxel_m) {
  std::set<std::array<int, 3>> cubes;
  for (const SceneObject& solid : solids) {
    const Eigen::Array3d half = std::get<BoxShape>(solid.shape).size / 2;
    const Eigen::Array3i steps = (half / voxel_m).ceil().cast<int>() * 2;
    // Points of the solid no further apart than half a cube.
    for (int i = -steps.x(); i <= steps.x(); ++i)
      for (int j = -steps.y(); j <= steps.y(); ++j)
        for (int k = -steps.z(); k <= steps.z(); ++k) {
          const Eigen::Array3d part = Eigen::Array3i(i, j, k).cast<double>() / steps.cast<double>();
          const Eigen::Vector3d p = solid.T_task_object * (part * half).matrix();
          const Eigen::Array3i cube = (p.array() / voxel_m).floor().cast<int>();
          cubes.insert({cube.x(), cube.y(), cube.z()});
        }
  }
  Eigen::Matrix3Xd middles(3, static_cast<Eigen::Index>(cubes.size()));
  Eigen::Index column = 0;
  for (const auto& [i, j, k] : cubes)
    middles.col(column++) = (Eigen::Array3d(i, j, k) + 0.5) * voxel_m;
  return middles;
}

DearScene draw_dear_scene(DearKind kind, std::mt19937_64& generator) {
  constexpr double kShift_m = 0.1, kTurn_rad = 0.3;
  constexpr double kVoxel_m = 0.02;
  Measures measures(generator);
  DearFurniture furniture = make_dear_furniture(kind, measures);
  Eigen::Isometry3d T_task_furniture(Eigen::Translation3d(
      nominal_x(kind) + measures.within(kShift_m), measures.within(2 * kShift_m), 0));
  T_task_furniture.rotate(Eigen::AngleAxisd(measures.within(kTurn_rad), Eigen::Vector3d::UnitZ()));
  DearScene instance;
  instance.scene.objects.push_back(
      {kFloorName, BoxShape{{4, 4, 0.1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.05))});
  if (kind == DearKind::Cloud) {
    // What is to be grasped has been taken out of it.
    const auto target = std::ranges::find(furniture.solids, kTargetName, &SceneObject::name);
    std::rotate(target, target + 1, furniture.solids.end());
    const std::vector<SceneObject> shelf(furniture.solids.begin(), furniture.solids.end() - 1);
    SceneCloud cloud{"shelf", {"", kVoxel_m}, T_task_furniture};
    cloud.cloud.voxels = std::make_shared<const Eigen::Matrix3Xd>(voxels_in(shelf, kVoxel_m));
    instance.scene.clouds.push_back(std::move(cloud));
    furniture.solids.erase(furniture.solids.begin(), furniture.solids.end() - 1);
  }
  for (SceneObject& solid : furniture.solids) {
    solid.T_task_object = T_task_furniture * solid.T_task_object;
    instance.scene.objects.push_back(std::move(solid));
  }
  instance.T_task_goal = T_task_furniture * furniture.T_furniture_goal;
  if (furniture.T_furniture_start)
    instance.T_task_start = T_task_furniture * *furniture.T_furniture_start;
  instance.held = std::move(furniture.held);
  return instance;
}

}  // namespace kinship::experiments
