#include "client/experiments/page/page_json.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "client/experiments/comparison_table.hpp"
#include "proto/types/pose.hpp"

namespace kinship::experiments {
namespace {

constexpr double kMillimetres = 1000;
constexpr double kPercent = 100;

/// A JSON string. What could end the script element or the string is escaped.
std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '<' || static_cast<unsigned char>(c) < ' ') {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      json += escaped;
    } else {
      json += c;
    }
  }
  return json + "\"";
}

std::string number(double value) {
  if (!std::isfinite(value))
    return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.8g", value);
  return text;
}

template <typename Values, typename ToJson>
std::string list(const Values& values, const ToJson& each_to_json) {
  std::string json = "[";
  for (const auto& value : values)
    json += (json.size() > 1 ? "," : "") + each_to_json(value);
  return json + "]";
}

std::string whole(const Eigen::Ref<const Eigen::MatrixXd>& values, double scale) {
  return list(values.reshaped(),
              [&](double value) { return std::to_string(std::lround(value * scale)); });
}

std::string json_of(const Poses& poses) {
  return "{\"positions\":" + whole(poses.positions, kMillimetres) +
         ",\"directions\":" + whole(poses.directions, kPercent) + "}";
}

std::string json_of(const FleetMember& member) {
  return "{\"label\":" + quoted(member.label) + ",\"problems\":" + std::to_string(member.problems) +
         ",\"paths\":" + list(member.paths, [](const Poses& path) { return json_of(path); }) + "}";
}

std::string json_of(const Bone& bone) {
  Eigen::Matrix<double, 7, 1> numbers;
  numbers << bone.from, bone.to, bone.radius_m;
  return whole(numbers, kMillimetres);
}

struct ShapeJson {
  std::string operator()(const BoxShape& box) const {
    return "\"box\":" + whole(box.size, kMillimetres);
  }
  std::string operator()(const CylinderShape& cylinder) const {
    return "\"cylinder\":" +
           whole(Eigen::Vector2d(cylinder.radius_m, cylinder.length_m), kMillimetres);
  }
  std::string operator()(const SphereShape& sphere) const {
    return "\"sphere\":" + number(std::round(sphere.radius_m * kMillimetres));
  }
  std::string operator()(const CapsuleShape& capsule) const {
    return "\"cylinder\":" +
           whole(Eigen::Vector2d(capsule.radius_m, capsule.length_m), kMillimetres);
  }
};

std::string json_of(const SceneObject& object) {
  return "{\"name\":" + quoted(object.name) +
         ",\"pose\":" + list(to_pose_array(object.T_task_object), number) + "," +
         std::visit(ShapeJson{}, object.shape) + "}";
}

std::string json_of(const Source& source) {
  return "{\"label\":" + quoted(source.label) + ",\"paths\":" + std::to_string(source.paths) +
         ",\"poses\":" + std::to_string(source.poses) +
         ",\"poses_solved\":" + std::to_string(source.poses_solved) + "}";
}

std::string json_of(const Distribution& distribution) {
  return "{\"id\":" + quoted(distribution.id.short_hex()) +
         ",\"revision\":" + std::to_string(distribution.revision) +
         ",\"task\":" + quoted(distribution.task) + ",\"profile\":" + quoted(distribution.profile) +
         ",\"components\":" + std::to_string(distribution.mixture->size()) +
         ",\"joints\":" + std::to_string(distribution.mixture->dimension()) +
         ",\"configurations\":" + std::to_string(distribution.configurations) +
         ",\"transfer_time_s\":" + number(distribution.transfer_time_s) +
         ",\"fit_time_s\":" + number(distribution.fit_time_s) + ",\"sources\":" +
         list(distribution.sources, [](const Source& source) { return json_of(source); }) + "}";
}

std::string json_of(const MeanInterval& interval) {
  return "{\"mean\":" + number(interval.mean) + ",\"low\":" + number(interval.low) +
         ",\"high\":" + number(interval.high) + "}";
}

std::string json_of(const Comparison& comparison) {
  std::ostringstream text;
  write_json(comparison, text);
  return text.str();
}

}  // namespace

std::string to_json(const PageData& data) {
  const auto bones = [](const std::vector<Bone>& posture) {
    return list(posture, [](const Bone& bone) { return json_of(bone); });
  };
  return "{\"robot\":" + quoted(data.robot) + ",\n\"fleet\":" +
         list(data.fleet, [](const FleetMember& member) { return json_of(member); }) +
         ",\n\"scene\":" +
         list(data.scene.objects, [](const SceneObject& object) { return json_of(object); }) +
         ",\n\"distribution\":" + json_of(data.distribution) +
         ",\n\"samples\":" + json_of(data.samples) +
         ",\n\"advice\":{\"share\":" + number(data.advice.recommended_share) +
         ",\"evidence\":" + quoted(data.advice.evidence) + "}" +
         ",\n\"free_share\":" + number(data.free_share) +
         ",\"uniform_free_share\":" + number(data.uniform_free_share) +
         ",\n\"postures\":" + list(data.postures, bones) +
         ",\n\"comparison\":" + json_of(data.comparison) +
         ",\n\"uniform_checks\":" + json_of(data.uniform_checks) +
         ",\"guided_checks\":" + json_of(data.guided_checks) + "}";
}

}  // namespace kinship::experiments
