#include "client/moveit/geometry_messages.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

namespace kinship::moveit {
namespace {

/// Numbers of a map `{x: , y: }` or of a list in the same order.
template <std::size_t kCount>
std::array<double, kCount> read_numbers(const YamlValue& value,
                                        const std::array<const char*, kCount>& names) {
  std::array<double, kCount> numbers{};
  if (value.is_map()) {
    for (std::size_t index = 0; index < kCount; ++index)
      numbers[index] = value[names[index]].number_or(0);
    return numbers;
  }
  const std::vector<YamlValue> items = value.items();
  if (items.size() != kCount)
    value.refuse(std::to_string(items.size()) + " numbers instead of " + std::to_string(kCount));
  for (std::size_t index = 0; index < kCount; ++index)
    numbers[index] = items[index].number();
  return numbers;
}

/// The kinds of shape_msgs/SolidPrimitive, by number and by word.
enum class SolidKind { Box, Sphere, Cylinder };

SolidKind read_kind(const YamlValue& value) {
  const std::string kind = value.text();
  if (kind == "1" || kind == "box")
    return SolidKind::Box;
  if (kind == "2" || kind == "sphere")
    return SolidKind::Sphere;
  if (kind == "3" || kind == "cylinder")
    return SolidKind::Cylinder;
  value.refuse("'" + kind +
               "' is no solid that can be taken: 1 or box, 2 or sphere, 3 or cylinder; make a mesh "
               "of others");
}

void require_count(const YamlValue& list, std::size_t found, std::size_t wanted) {
  if (found != wanted)
    list.refuse(std::to_string(found) + " numbers instead of " + std::to_string(wanted));
}

/// A corner's index into the vertices, from 0.
std::uint64_t read_corner(const YamlValue& value, std::size_t vertices) {
  const double corner = value.number();
  if (!(corner >= 0 && corner < static_cast<double>(vertices)) || corner != std::floor(corner))
    value.refuse("'" + value.text() + "' is none of " + std::to_string(vertices) + " vertices");
  return static_cast<std::uint64_t>(corner);
}

}  // namespace

Eigen::Vector3d read_vector(const YamlValue& value) {
  if (value.is_missing())
    return Eigen::Vector3d::Zero();
  const auto [x, y, z] = read_numbers<3>(value, {"x", "y", "z"});
  return {x, y, z};
}

Eigen::Quaterniond read_rotation(const YamlValue& value) {
  if (value.is_missing())
    return Eigen::Quaterniond::Identity();
  const auto [x, y, z, w] = read_numbers<4>(value, {"x", "y", "z", "w"});
  const Eigen::Quaterniond rotation(w, x, y, z);
  if (rotation.norm() == 0)
    return Eigen::Quaterniond::Identity();
  // A rounded quaternion has six digits; further off, another order was meant.
  constexpr double kTolerance = 1e-2;
  if (std::abs(rotation.norm() - 1) > kTolerance)
    value.refuse("is no rotation: the quaternion's norm is " + std::to_string(rotation.norm()));
  return rotation.normalized();
}

Eigen::Isometry3d read_pose(const YamlValue& value) {
  Eigen::Isometry3d pose(read_rotation(value.first_of({"orientation", "rotation"})));
  pose.translation() = read_vector(value.first_of({"position", "translation"}));
  return pose;
}

Shape read_solid(const YamlValue& value) {
  const SolidKind kind = read_kind(value["type"]);
  const YamlValue list = value["dimensions"];
  std::vector<double> sizes;
  for (const YamlValue& size : list.items()) {
    sizes.push_back(size.number());
    if (!(sizes.back() > 0))
      size.refuse("'" + size.text() + "' is no size above 0");
  }
  switch (kind) {
    case SolidKind::Box:
      require_count(list, sizes.size(), 3);
      return BoxShape{.size = {sizes[0], sizes[1], sizes[2]}};
    case SolidKind::Sphere:
      require_count(list, sizes.size(), 1);
      return SphereShape{.radius_m = sizes[0]};
    case SolidKind::Cylinder:
      break;
  }
  // Height, then radius.
  require_count(list, sizes.size(), 2);
  return CylinderShape{.radius_m = sizes[1], .length_m = sizes[0]};
}

std::string read_mesh(const YamlValue& value) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  const std::vector<YamlValue> vertices = value["vertices"].items();
  for (const YamlValue& vertex : vertices) {
    const Eigen::Vector3d place = read_vector(vertex);
    text << "v " << place.x() << ' ' << place.y() << ' ' << place.z() << '\n';
  }
  const std::vector<YamlValue> triangles = value["triangles"].items();
  if (triangles.empty())
    value.refuse("a mesh without triangles");
  for (const YamlValue& triangle : triangles) {
    const YamlValue list = triangle.is_map() ? triangle["vertex_indices"] : triangle;
    const std::vector<YamlValue> corners = list.items();
    require_count(list, corners.size(), 3);
    text << 'f';
    for (const YamlValue& corner : corners)
      text << ' ' << read_corner(corner, vertices.size()) + 1;  // OBJ counts from 1
    text << '\n';
  }
  return text.str();
}

}  // namespace kinship::moveit
