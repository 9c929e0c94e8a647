#include "pages/page/json_text.hpp"

#include <cmath>
#include <cstdio>
#include <variant>

#include "proto/types/pose.hpp"

namespace kinship::page {
namespace {

constexpr double kMillimetres = 1000;

struct ShapeJson {
  std::string operator()(const BoxShape& box) const { return "\"box\":" + millimetres(box.size); }
  std::string operator()(const CylinderShape& cylinder) const {
    return "\"cylinder\":" + millimetres(Eigen::Vector2d(cylinder.radius_m, cylinder.length_m));
  }
  std::string operator()(const SphereShape& sphere) const {
    return "\"sphere\":" + std::to_string(std::lround(sphere.radius_m * kMillimetres));
  }
  std::string operator()(const CapsuleShape& capsule) const {
    return "\"capsule\":" + millimetres(Eigen::Vector2d(capsule.radius_m, capsule.length_m));
  }
};

}  // namespace

std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < ' ') {
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

std::string whole(const Eigen::Ref<const Eigen::MatrixXd>& values, double scale) {
  return list(values.reshaped(),
              [&](double value) { return std::to_string(std::lround(value * scale)); });
}

std::string millimetres(const Eigen::Ref<const Eigen::MatrixXd>& lengths_m) {
  return whole(lengths_m, kMillimetres);
}

std::string object(std::initializer_list<std::pair<std::string_view, std::string>> members) {
  std::string json = "{";
  for (const auto& [name, value] : members)
    json.append(json.size() > 1 ? "," : "").append(json_string(name)).append(":").append(value);
  return json + "}";
}

std::string json_of(const SceneObject& object) {
  return "{\"name\":" + json_string(object.name) +
         ",\"pose\":" + list(to_pose_array(object.T_task_object), number) + "," +
         std::visit(ShapeJson{}, object.shape) +
         (object.approximate ? ",\"approximate\":true}" : "}");
}

std::string json_of(const std::vector<SceneObject>& objects) {
  return list(objects, [](const SceneObject& object) { return json_of(object); });
}

std::string json_of(const std::vector<Bone>& bones) {
  return list(bones, [](const Bone& bone) {
    Eigen::Matrix<double, 7, 1> numbers;
    numbers << bone.from, bone.to, bone.radius_m;
    return millimetres(numbers);
  });
}

}  // namespace kinship::page
