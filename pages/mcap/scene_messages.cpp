#include "pages/mcap/scene_messages.hpp"

#include <initializer_list>
#include <string_view>
#include <utility>
#include <variant>

#include "pages/page/json_text.hpp"
#include "proto/types/pose.hpp"

namespace kinship::mcap {
namespace {

using page::json_string;
using page::list;
using page::number;
using page::object;

constexpr double kLine_m = 0.005, kCaption_px = 14;
constexpr const char* kNoTime = R"({"sec":0,"nsec":0})";

// Values.

std::string json_of(std::chrono::nanoseconds time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  return object({{"sec", std::to_string(seconds.count())},
                 {"nsec", std::to_string((time - seconds).count())}});
}

std::string json_of(const Eigen::Vector3d& vector) {
  return object({{"x", number(vector.x())}, {"y", number(vector.y())}, {"z", number(vector.z())}});
}

std::string rotation_json(const Eigen::Isometry3d& T_a_b) {
  const PoseArray pose = to_pose_array(T_a_b);
  return object({{"x", number(pose[3])},
                 {"y", number(pose[4])},
                 {"z", number(pose[5])},
                 {"w", number(pose[6])}});
}

std::string json_of(const Eigen::Isometry3d& T_a_b) {
  return object({{"position", json_of(Eigen::Vector3d(T_a_b.translation()))},
                 {"orientation", rotation_json(T_a_b)}});
}

std::string json_of(const Color& color) {
  return object({{"r", number(color[0])},
                 {"g", number(color[1])},
                 {"b", number(color[2])},
                 {"a", number(color[3])}});
}

/// The primitives of an entity by their kinds.
class Primitives {
 public:
  explicit Primitives(const Color& color) : color_(json_of(color)) {}

  void add(const Solid& solid) {
    std::visit([&](const auto& shape) { add(shape, solid.T_frame_shape); }, solid.shape);
  }

  const std::vector<std::string>& cubes() const noexcept { return cubes_; }
  const std::vector<std::string>& spheres() const noexcept { return spheres_; }
  const std::vector<std::string>& cylinders() const noexcept { return cylinders_; }

 private:
  void add(const BoxShape& box, const Eigen::Isometry3d& T) {
    cubes_.push_back(
        object({{"pose", json_of(T)}, {"size", json_of(box.size)}, {"color", color_}}));
  }
  void add(const SphereShape& sphere, const Eigen::Isometry3d& T) {
    const Eigen::Vector3d size = Eigen::Vector3d::Constant(2 * sphere.radius_m);
    spheres_.push_back(object({{"pose", json_of(T)}, {"size", json_of(size)}, {"color", color_}}));
  }
  void add(const CylinderShape& cylinder, const Eigen::Isometry3d& T) {
    const Eigen::Vector3d size(2 * cylinder.radius_m, 2 * cylinder.radius_m, cylinder.length_m);
    cylinders_.push_back(object({{"pose", json_of(T)},
                                 {"size", json_of(size)},
                                 {"bottom_scale", "1"},
                                 {"top_scale", "1"},
                                 {"color", color_}}));
  }
  void add(const CapsuleShape& capsule, const Eigen::Isometry3d& T) {
    add(CylinderShape{capsule.radius_m, capsule.length_m}, T);
    for (const double end : {-0.5, 0.5})
      add(SphereShape{capsule.radius_m}, T * Eigen::Translation3d(0, 0, end * capsule.length_m));
  }

  std::string color_;
  std::vector<std::string> cubes_, spheres_, cylinders_;
};

std::string in_list(const std::string& json) { return std::string("[").append(json).append("]"); }

std::string line_json(const Eigen::Matrix3Xd& points, const Color& color) {
  return object({{"type", "0"},  // a strip
                 {"pose", json_of(Eigen::Isometry3d::Identity())},
                 {"thickness", number(kLine_m)},
                 {"scale_invariant", "false"},
                 {"points", list(points.colwise(),
                                 [](const Eigen::Vector3d& point) { return json_of(point); })},
                 {"color", json_of(color)}});
}

std::string caption_json(const Entity& entity) {
  Eigen::Isometry3d T_frame_text = Eigen::Isometry3d::Identity();
  if (entity.line.cols() > 0)
    T_frame_text.translation() = entity.line.col(0);
  return object({{"pose", json_of(T_frame_text)},
                 {"billboard", "true"},
                 {"font_size", number(kCaption_px)},
                 {"scale_invariant", "true"},
                 {"color", json_of(entity.color)},
                 {"text", json_string(entity.caption)}});
}

std::string json_of(const Entity& entity, std::chrono::nanoseconds time) {
  const auto as_it_is = [](const std::string& json) { return json; };
  Primitives primitives(entity.color);
  for (const Solid& solid : entity.solids)
    primitives.add(solid);
  const auto key_value = [](const auto& pair) {
    return object({{"key", json_string(pair.first)}, {"value", json_string(pair.second)}});
  };
  return object(
      {{"timestamp", json_of(time)},
       {"frame_id", json_string(entity.frame)},
       {"id", json_string(entity.id)},
       {"lifetime", kNoTime},
       {"frame_locked", "true"},
       {"metadata", list(entity.metadata, key_value)},
       {"cubes", list(primitives.cubes(), as_it_is)},
       {"spheres", list(primitives.spheres(), as_it_is)},
       {"cylinders", list(primitives.cylinders(), as_it_is)},
       {"lines", entity.line.cols() > 0 ? in_list(line_json(entity.line, entity.color)) : "[]"},
       {"texts", entity.caption.empty() ? "[]" : in_list(caption_json(entity))}});
}

// Schemas.

using Members = std::initializer_list<std::pair<std::string_view, std::string>>;

std::string typed(std::string_view type) { return object({{"type", json_string(type)}}); }

std::string titled(std::string_view title, Members members) {
  return object({{"title", json_string(title)},
                 {"type", json_string("object")},
                 {"properties", object(members)}});
}

std::string list_of(const std::string& items) {
  return object({{"type", json_string("array")}, {"items", items}});
}

/// Types that both messages use.
struct Types {
  std::string number = typed("number"), integer = typed("integer"), text = typed("string"),
              truth = typed("boolean");
  std::string time = titled("time", {{"sec", integer}, {"nsec", integer}});
  std::string duration = titled("duration", {{"sec", integer}, {"nsec", integer}});
  std::string vector = titled("foxglove.Vector3", {{"x", number}, {"y", number}, {"z", number}});
  std::string point = titled("foxglove.Point3", {{"x", number}, {"y", number}, {"z", number}});
  std::string quaternion =
      titled("foxglove.Quaternion", {{"x", number}, {"y", number}, {"z", number}, {"w", number}});
  std::string pose = titled("foxglove.Pose", {{"position", vector}, {"orientation", quaternion}});
  std::string color =
      titled("foxglove.Color", {{"r", number}, {"g", number}, {"b", number}, {"a", number}});
};

std::string entity_schema(const Types& type) {
  const Members solid = {{"pose", type.pose}, {"size", type.vector}, {"color", type.color}};
  return titled(
      "foxglove.SceneEntity",
      {{"timestamp", type.time},
       {"frame_id", type.text},
       {"id", type.text},
       {"lifetime", type.duration},
       {"frame_locked", type.truth},
       {"metadata",
        list_of(titled("foxglove.KeyValuePair", {{"key", type.text}, {"value", type.text}}))},
       {"cubes", list_of(titled("foxglove.CubePrimitive", solid))},
       {"spheres", list_of(titled("foxglove.SpherePrimitive", solid))},
       {"cylinders", list_of(titled("foxglove.CylinderPrimitive", {{"pose", type.pose},
                                                                   {"size", type.vector},
                                                                   {"bottom_scale", type.number},
                                                                   {"top_scale", type.number},
                                                                   {"color", type.color}}))},
       {"lines", list_of(titled("foxglove.LinePrimitive", {{"type", type.integer},
                                                           {"pose", type.pose},
                                                           {"thickness", type.number},
                                                           {"scale_invariant", type.truth},
                                                           {"points", list_of(type.point)},
                                                           {"color", type.color}}))},
       {"texts", list_of(titled("foxglove.TextPrimitive", {{"pose", type.pose},
                                                           {"billboard", type.truth},
                                                           {"font_size", type.number},
                                                           {"scale_invariant", type.truth},
                                                           {"color", type.color},
                                                           {"text", type.text}}))}});
}

}  // namespace

std::string scene_update(std::chrono::nanoseconds time, const std::vector<Entity>& entities) {
  const std::string all = object({{"timestamp", json_of(time)}, {"type", "1"}, {"id", "\"\""}});
  return object({{"deletions", in_list(all)},
                 {"entities",
                  list(entities, [time](const Entity& entity) { return json_of(entity, time); })}});
}

Schema scene_update_schema() {
  constexpr const char* kName = "foxglove.SceneUpdate";
  const Types type;
  const std::string deletion =
      titled("foxglove.SceneEntityDeletion",
             {{"timestamp", type.time}, {"type", type.integer}, {"id", type.text}});
  return {kName, titled(kName, {{"deletions", list_of(deletion)},
                                {"entities", list_of(entity_schema(type))}})};
}

std::string frame_transforms(std::chrono::nanoseconds time,
                             const std::vector<FrameTransform>& transforms) {
  const std::string timestamp = json_of(time);
  return object({{"transforms", list(transforms, [&](const FrameTransform& each) {
                    const Eigen::Isometry3d& T = each.T_parent_child;
                    return object({{"timestamp", timestamp},
                                   {"parent_frame_id", json_string(each.parent)},
                                   {"child_frame_id", json_string(each.child)},
                                   {"translation", json_of(Eigen::Vector3d(T.translation()))},
                                   {"rotation", rotation_json(T)}});
                  })}});
}

Schema frame_transforms_schema() {
  constexpr const char* kName = "foxglove.FrameTransforms";
  const Types type;
  const std::string transform = titled("foxglove.FrameTransform", {{"timestamp", type.time},
                                                                   {"parent_frame_id", type.text},
                                                                   {"child_frame_id", type.text},
                                                                   {"translation", type.vector},
                                                                   {"rotation", type.quaternion}});
  return {kName, titled(kName, {{"transforms", list_of(transform)}})};
}

}  // namespace kinship::mcap
