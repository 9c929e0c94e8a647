#include "robots/geometry/geometry_doubts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "robots/geometry/fitted_shape.hpp"

namespace kinship::geometry {
namespace {

// A link that moves and sticks out farther than the whole chain reaches is drawn in another unit: a
// mesh in mm that is read as m is a thousand times too large. Three, because a tool may be long.
constexpr double kMaxMovingExtent = 3;
// With so many times the reach it cannot be meant: a finger of 50 mm in mm has as much.
constexpr double kImpossibleMovingExtent = 50;
// A link that stands still may be a table, a cell's floor or its walls, so it gets more room; a
// base of a tenth of the reach in mm has a hundred times the reach.
constexpr double kMaxStandingExtent = 50;
// The other way round: a link of an arm that reaches 1 m is not smaller than 1 mm.
constexpr double kMinExtent = 1e-3;
// A tool is seldom longer than the arm.
constexpr double kMaxTool = 2;
constexpr double kImpossibleTool = 10;
// A gantry may be as long, m; more without the strokes of its rails is no arm.
constexpr double kLargestReach_m = 50;
constexpr double kImpossibleReach_m = 200;
// A hall's floor may be as large, of the reach.
constexpr double kMaxObstacle = 100;
// A place so far away, of the reach, is no mistake of a few metres.
constexpr double kFarPlace = 10;
constexpr double kMillimetre_m = 1e-3;
// For the bounds an arm reaches at least this far: the tip of a chain of one joint may lie on its
// axis.
constexpr double kShortestReach_m = 0.5;

using Extents = Eigen::AlignedBox3d;

/// Three digits that count, in any locale.
std::string short_text(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::general, /*precision=*/3);
  return {text.data(), error == std::errc() ? end : text.data()};
}

Extents box_of(const Shape& shape) {
  const Eigen::Vector3d half_m = half_extents_m(shape);
  return {-half_m, half_m};
}

Extents box_of(const Eigen::Matrix3Xd& points) {
  return {Eigen::Vector3d(points.rowwise().minCoeff()),
          Eigen::Vector3d(points.rowwise().maxCoeff())};
}

Extents box_of(const LinkShape& shape) {
  if (!shape.triangles)
    return box_of(shape.shape).transformed(shape.T_link_shape);
  return box_of(Eigen::Matrix3Xd(shape.T_link_shape * *shape.triangles));
}

/// Distance of the origin from the box's farthest corner.
double farthest_m(const Extents& box) {
  return box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
}

/// How far the moving frame of each moving joint can get from the base link's origin.
/// \param stroke  of the sliding joints that counts, 1 or 0.
std::vector<double> joint_reaches_m(const kinematics::Chain& chain, double stroke = 1) {
  std::vector<double> reaches_m;
  for (int j = 0; j < chain.moving_joints(); ++j) {
    const kinematics::Joint& joint = chain.moving_joint(j);
    const int before = chain.joint_before(j);
    double reach = before < 0 ? 0 : reaches_m[static_cast<std::size_t>(before)];
    reach += joint.T_previous_joint.translation().norm();
    if (joint.type == kinematics::JointType::Prismatic)
      reach += stroke * std::max(std::abs(joint.lower), std::abs(joint.upper));
    reaches_m.push_back(reach);
  }
  return reaches_m;
}

/// How far a link's origin can get from the base link's.
double reach_of_link_m(const kinematics::ChainLink& link, const std::vector<double>& joints_m) {
  return link.T_joint_link.translation().norm() +
         (link.joint < 0 ? 0 : joints_m[static_cast<std::size_t>(link.joint)]);
}

/// "'a', 'b' and 3 more".
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, names.size()); ++i)
    text += (i == 0 ? "'" : ", '") + names[i] + "'";
  return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more"
                              : text;
}

std::string have_visuals(const std::vector<std::string>& links) {
  return (links.size() == 1 ? "link " + listed(links) + " has"
                            : "links " + listed(links) + " have") +
         " <visual> and no <collision>";
}

constexpr const char* kWhatToDo =
    "give them <collision> elements in the URDF, or pass --collision-from-visual (what is drawn is "
    "taken for solid), or --without-collision LINK for each that needs none";

std::vector<std::string> visual_only(const kinematics::Chain& chain, const RobotShapes& shapes,
                                     bool moving) {
  std::vector<std::string> names;
  for (const int index : shapes.visual_only) {
    const kinematics::ChainLink& link = chain.links()[static_cast<std::size_t>(index)];
    if ((link.joint >= 0) == moving)
      names.push_back(link.name);
  }
  return names;
}

double scale_of(double reach_m) { return std::max(reach_m, kShortestReach_m); }

/// "; these are probably millimetres (0.4 m)" of a length that is too large, if it would be likely
/// as such; else "; lengths are m".
/// \param likely_m  the largest that would be.
std::string unit_text(double length_m, double likely_m) {
  constexpr double kSmallest = 0.005;  // of the largest
  const double as_millimetres_m = kMillimetre_m * length_m;
  return as_millimetres_m > likely_m || as_millimetres_m < kSmallest * likely_m
             ? "; lengths are m"
             : "; these are probably millimetres (" + short_text(as_millimetres_m) + " m)";
}

/// A link that is far too large.
std::string too_large_text(const LinkExtent& extent, double reach_m) {
  return "link '" + extent.link + "' of an arm that reaches " + short_text(reach_m) + " m is " +
         short_text(extent.size_m.maxCoeff()) + " m long and sticks out " +
         short_text(extent.farthest_m) + " m from its origin" +
         unit_text(extent.farthest_m, kMaxMovingExtent * scale_of(reach_m)) +
         ": a mesh in mm needs scale=\"0.001 0.001 0.001\" in the URDF";
}

/// The doubt about a link's size; empty if it may be meant.
std::string size_doubt(const LinkExtent& extent, double reach_m) {
  const double length_m = extent.size_m.maxCoeff();
  const double scale_m = scale_of(reach_m);
  const double limit_m = (extent.moves ? kMaxMovingExtent : kMaxStandingExtent) * scale_m;
  const std::string link = "link '" + extent.link + "'";
  const std::string reach = " of an arm that reaches " + short_text(reach_m) + " m";
  if (extent.farthest_m > limit_m)
    return too_large_text(extent, reach_m);
  if (length_m < kMinExtent * scale_m)
    return link + reach + " is only " + short_text(1000 * length_m) +
           " mm long: lengths in a URDF are m; is its mesh scaled twice?";
  return "";
}

std::string reach_doubt(double reach_m) {
  return "the arm reaches " + short_text(reach_m) + " m from its base, stretched out" +
         unit_text(reach_m, kLargestReach_m);
}

/// The transfer frame's distance from the tip link where that is too far.
std::string tool_doubt(const kinematics::Chain& chain) {
  const double tool_m = transfer_distance_m(chain), arm_m = reach_m(chain);
  return "the transfer frame is " + short_text(tool_m) + " m away from its tip link '" +
         chain.tip_link() + "', of an arm that reaches " + short_text(arm_m) + " m" +
         unit_text(tool_m, kMaxTool * scale_of(arm_m));
}

/// An object of a scene or of a hand, to be looked at.
struct Placed {
  std::string name;
  Extents box;                   // in its own frame
  Eigen::Isometry3d T_task_box;  // of that frame
};

std::vector<Placed> placed_in(const Scene& scene) {
  std::vector<Placed> all;
  for (const SceneObject& object : scene.objects)
    all.push_back({object.name, box_of(object.shape), object.T_task_object});
  for (const SceneMesh& object : scene.meshes)
    if (object.mesh.triangles && object.mesh.triangles->cols() > 0)
      all.push_back({object.name, box_of(*object.mesh.triangles), object.T_task_mesh});
  for (const SceneCloud& object : scene.clouds)
    if (object.cloud.voxels && object.cloud.voxels->cols() > 0)
      all.push_back({object.name, box_of(*object.cloud.voxels), object.T_task_cloud});
  return all;
}

/// How far from the base link's origin anything of the robot can get.
double reach_of_solids_m(const kinematics::Chain& chain, const RobotShapes& shapes,
                         const std::vector<AttachedObject>& attached) {
  const std::vector<double> joints_m = joint_reaches_m(chain);
  double reach = reach_m(chain) + transfer_distance_m(chain);
  for (const LinkShape& shape : shapes.shapes) {
    const auto& link = chain.links()[static_cast<std::size_t>(shape.link)];
    reach = std::max(reach, reach_of_link_m(link, joints_m) + farthest_m(box_of(shape)));
  }
  for (const AttachedObject& object : attached) {
    const int index = chain.find_link(object.link);
    if (index < 0)
      continue;
    const Extents box = object.mesh && object.mesh->triangles ? box_of(*object.mesh->triangles)
                                                              : box_of(object.shape);
    reach =
        std::max(reach, reach_of_link_m(chain.links()[static_cast<std::size_t>(index)], joints_m) +
                            object.T_link_object.translation().norm() + farthest_m(box));
  }
  return reach;
}

}  // namespace

const char* to_text(SolidsFrom from) {
  switch (from) {
    case SolidsFrom::Collision:
      return "collision";
    case SolidsFrom::Visual:
      return "visual";
    case SolidsFrom::VisualOnly:
      return "none (visual only)";
    default:
      return "none";
  }
}

std::vector<LinkExtent> link_extents(const kinematics::Chain& chain, const RobotShapes& shapes) {
  std::vector<LinkExtent> extents(chain.links().size());
  std::vector<Extents> boxes(extents.size());
  for (std::size_t i = 0; i < extents.size(); ++i) {
    extents[i].link = chain.links()[i].name;
    extents[i].moves = chain.links()[i].joint >= 0;
  }
  for (const LinkShape& shape : shapes.shapes) {
    const auto link = static_cast<std::size_t>(shape.link);
    boxes[link].extend(box_of(shape));
    ++extents[link].solids;
    extents[link].from = SolidsFrom::Collision;
  }
  for (const int link : shapes.visual_only)
    extents[static_cast<std::size_t>(link)].from = SolidsFrom::VisualOnly;
  for (const int link : shapes.from_visual)
    extents[static_cast<std::size_t>(link)].from = SolidsFrom::Visual;
  for (std::size_t i = 0; i < extents.size(); ++i)
    if (!boxes[i].isEmpty()) {
      extents[i].size_m = boxes[i].sizes();
      extents[i].farthest_m = farthest_m(boxes[i]);
    }
  return extents;
}

double reach_m(const kinematics::Chain& chain) {
  return joint_reaches_m(chain)[chain.joints().size() - 1] +
         chain.T_last_tip().translation().norm();
}

double transfer_distance_m(const kinematics::Chain& chain) {
  return chain.T_tip_transfer().translation().norm();
}

std::vector<std::string> find_doubts(const kinematics::Chain& chain, const RobotShapes& shapes) {
  std::vector<std::string> doubts;
  const auto moving = visual_only(chain, shapes, true);
  if (!moving.empty())
    doubts.push_back(have_visuals(moving) +
                     ": they pass through everything, and kinship-plan refuses the robot; " +
                     kWhatToDo);
  const auto standing = visual_only(chain, shapes, false);
  if (!standing.empty())
    doubts.push_back(have_visuals(standing) + ": the robot passes through them; " + kWhatToDo);
  if (shapes.shapes.empty() && shapes.left_out.empty() && moving.empty())
    doubts.push_back(
        "no link has a solid: the robot passes through everything; give its links <collision> "
        "elements in the URDF");
  if (reach_m(chain) > kLargestReach_m)
    doubts.push_back(reach_doubt(reach_m(chain)));
  if (transfer_distance_m(chain) > kMaxTool * scale_of(reach_m(chain)))
    doubts.push_back(tool_doubt(chain));
  for (const LinkExtent& extent : link_extents(chain, shapes))
    if (extent.solids > 0)
      if (std::string doubt = size_doubt(extent, reach_m(chain)); !doubt.empty())
        doubts.push_back(std::move(doubt));
  return doubts;
}

std::optional<Error> find_impossible_lengths(const kinematics::Chain& chain) {
  const double arm_m = joint_reaches_m(chain, 0)[chain.joints().size() - 1] +
                       chain.T_last_tip().translation().norm();
  if (arm_m > kImpossibleReach_m)
    return invalid_input(reach_doubt(arm_m) + ": more than " + short_text(kImpossibleReach_m) +
                         " m, rails not counted, is taken for no arm");
  if (transfer_distance_m(chain) > kImpossibleTool * scale_of(reach_m(chain)))
    return invalid_input(tool_doubt(chain) + ": at most " + short_text(kImpossibleTool) +
                         " times the reach is taken for a tool, and at least " +
                         short_text(kImpossibleTool * kShortestReach_m) + " m");
  return std::nullopt;
}

std::optional<Error> find_impossible_solids(const kinematics::Chain& chain,
                                            const RobotShapes& shapes) {
  for (const LinkExtent& extent : link_extents(chain, shapes))
    if (extent.moves && extent.farthest_m > kImpossibleMovingExtent * scale_of(reach_m(chain)))
      return invalid_input(too_large_text(extent, reach_m(chain)) + "; more than " +
                           short_text(kImpossibleMovingExtent) +
                           " times the reach is taken for no link");
  return std::nullopt;
}

std::string describe_far_place(const kinematics::Chain& chain,
                               const Eigen::Vector3d& p_base_place) {
  const double reach = reach_m(chain) + transfer_distance_m(chain);
  const double distance_m = p_base_place.norm();
  if (distance_m <= kFarPlace * scale_of(reach))
    return "";
  return "it is " + short_text(distance_m) + " m away from the robot's base, which gets " +
         short_text(reach) + " m far" + unit_text(distance_m, scale_of(reach));
}

std::optional<Error> find_missing_solids(const kinematics::Chain& chain,
                                         const RobotShapes& shapes) {
  const auto links = visual_only(chain, shapes, true);
  if (links.empty())
    return std::nullopt;
  return invalid_input(have_visuals(links) + ", so paths would lead through obstacles; " +
                       kWhatToDo);
}

std::optional<Error> find_faults(const kinematics::Chain& chain, const RobotShapes& shapes) {
  auto error = find_missing_solids(chain, shapes);
  return error ? error : find_impossible_solids(chain, shapes);
}

std::vector<std::string> find_scene_doubts(const kinematics::Chain& chain,
                                           const RobotShapes& shapes,
                                           const Eigen::Isometry3d& T_task_base, const Scene& scene,
                                           const std::vector<AttachedObject>& attached) {
  const double reach = reach_of_solids_m(chain, shapes, attached);
  const std::string robot = " the robot's base, which gets " + short_text(reach) + " m far";
  std::vector<std::string> sentences;
  for (const Placed& placed : placed_in(scene)) {
    const Eigen::Vector3d p_box_base =
        placed.T_task_box.inverse(Eigen::Isometry) * T_task_base.translation();
    const double distance_m = placed.box.exteriorDistance(p_box_base);
    const double length_m = placed.box.sizes().maxCoeff();
    if (distance_m > reach)
      sentences.push_back("'" + placed.name + "' is " + short_text(distance_m) + " m away from" +
                          robot + ": it is never touched" + unit_text(distance_m, reach) +
                          "; poses are in the task frame");
    else if (length_m > kMaxObstacle * scale_of(reach))
      sentences.push_back("'" + placed.name + "' is " + short_text(length_m) + " m long, around" +
                          robot + unit_text(length_m, kMaxMovingExtent * scale_of(reach)));
  }
  return sentences;
}

}  // namespace kinship::geometry
