#include "proto/types/recorded_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/sha256.hpp"

namespace kinship {
namespace {

constexpr std::size_t kThingBytes = 96;  // of an object on the wire, without its name
constexpr std::size_t kPairBytes = 16;
constexpr std::size_t kConstraintBytes = 216;

using Pair = std::pair<std::string, std::string>;

std::size_t extent_count(const Shape& shape) {
  constexpr std::array<std::size_t, 4> kCounts = {3, 2, 1, 2};  // in the order of the variant
  return kCounts.at(shape.index());
}

std::optional<Error> too_many(std::string_view what, std::size_t count, std::size_t limit) {
  if (count <= limit)
    return std::nullopt;
  return Error{ErrorCode::TooLarge, "scene: " + std::to_string(count) + " " + std::string(what) +
                                        " exceed " + std::to_string(limit)};
}

std::optional<Error> check_name(const std::string& name) {
  if (name.empty())
    return Error{ErrorCode::InvalidInput, "scene: a name is empty"};
  return check_text("scene: a name", name, kMaxLinkNameBytes);
}

std::optional<Error> check_thing(const std::string& name, const Shape& shape,
                                 const Eigen::Isometry3d& T) {
  if (auto error = check_name(name))
    return error;
  const std::string who = "scene: '" + name + "': ";
  const std::array<double, 3> sizes = to_numbers(shape).sizes;
  for (std::size_t i = 0; i < extent_count(shape); ++i)
    if (!(sizes.at(i) > 0 && sizes.at(i) <= kMaxPlacement_m))  // so that NaN breaks it
      return Error{ErrorCode::InvalidInput, who + "size " + number_text(sizes.at(i)) +
                                                " m is not above 0 and at most " +
                                                number_text(kMaxPlacement_m) + " m"};
  if (const auto pose = from_pose_array(to_pose_array(T)); !pose)
    return Error{pose.error().code, who + pose.error().message};
  return std::nullopt;
}

std::optional<Error> check_constraint(const TaskSpaceRegion& region) {
  const std::string who = "scene: constraint: ";
  if (const auto fault = validate(region))
    return Error{ErrorCode::InvalidInput, who + *fault};
  for (const auto& [name, T] :
       {std::pair("T0_w: ", &region.T_task_region), std::pair("Tw_e: ", &region.T_region_end)})
    if (const auto pose = from_pose_array(to_pose_array(*T)); !pose)
      return Error{pose.error().code, who + name + pose.error().message};
  return std::nullopt;
}

std::optional<Error> check_pairs(const RecordedScene& scene) {
  std::set<std::string_view> names;
  for (const SceneObject& object : scene.objects)
    names.insert(object.name);
  for (const HeldObject& held : scene.held)
    names.insert(held.name);
  for (const auto& [first, second] : scene.allowed_collisions)
    for (const std::string* name : {&first, &second})
      if (!names.contains(*name))
        return Error{ErrorCode::InvalidInput, "scene: allowed_collisions names '" +
                                                  cut_text(*name, kMaxLinkNameBytes) +
                                                  "', which is neither an object nor held"};
  return std::nullopt;
}

std::int64_t rounded(double number) {
  constexpr double kPerUnit = 1e9;
  return std::llround(number * kPerUnit);
}

/// The same for a bound that may be infinite, or too large to be counted in such units.
std::int64_t rounded_bound(double bound) {
  constexpr double kLargest = 9e9;
  if (std::abs(bound) <= kLargest)
    return rounded(bound);
  return bound > 0 ? std::numeric_limits<std::int64_t>::max()
                   : std::numeric_limits<std::int64_t>::min();
}

using RoundedPose = std::array<std::int64_t, 7>;

RoundedPose rounded(const Eigen::Isometry3d& T) {
  const PoseArray pose = to_pose_array(T);
  RoundedPose numbers{};
  std::transform(pose.begin(), pose.end(), numbers.begin(), [](double n) { return rounded(n); });
  // q and -q are one rotation, and which of them a half turn comes back as is rounding.
  const auto rotation = numbers.begin() + 3;
  const auto first = std::find_if(rotation, numbers.end(), [](auto n) { return n != 0; });
  if (first != numbers.end() && *first < 0)
    std::transform(rotation, numbers.end(), rotation, std::negate<>());
  return numbers;
}

/// A thing as numbers and text that compare equal where its content does.
using Thing = std::tuple<std::string, std::size_t, std::array<std::int64_t, 10>>;

/// Added to the kind of a shape that was fitted around a mesh.
constexpr std::size_t kApproximateKind = 1000;

Thing thing_of(const std::string& name, const Shape& shape, const Eigen::Isometry3d& T,
               bool approximate) {
  std::array<std::int64_t, 10> numbers{};
  const std::array<double, 3> sizes = to_numbers(shape).sizes;
  std::transform(sizes.begin(), sizes.end(), numbers.begin(), [](double n) { return rounded(n); });
  const RoundedPose pose = rounded(T);
  std::copy_n(pose.begin(), std::holds_alternative<SphereShape>(shape) ? 3 : pose.size(),
              numbers.begin() + 3);
  return {name, shape.index() + (approximate ? kApproximateKind : 0), numbers};
}

void add(std::vector<Thing> things, Sha256& hash) {
  std::sort(things.begin(), things.end());
  hash.add(std::uint64_t{things.size()});
  for (const auto& [name, kind, numbers] : things) {
    hash.add(std::string_view(name)).add(std::uint64_t{kind});
    for (const std::int64_t number : numbers)
      hash.add(static_cast<std::uint64_t>(number));
  }
}

/// Nothing for no constraint.
void add(const std::optional<TaskSpaceRegion>& constraint, Sha256& hash) {
  if (!constraint)
    return;
  hash.add(std::string_view("constraint"));
  for (const Eigen::Isometry3d* T : {&constraint->T_task_region, &constraint->T_region_end})
    for (const std::int64_t number : rounded(*T))
      hash.add(static_cast<std::uint64_t>(number));
  for (const double bound : constraint->bounds.reshaped())
    hash.add(static_cast<std::uint64_t>(rounded_bound(bound)));
}

}  // namespace

ShapeNumbers to_numbers(const Shape& shape) {
  struct Sizes {
    std::array<double, 3> operator()(const BoxShape& box) const {
      return {box.size.x(), box.size.y(), box.size.z()};
    }
    std::array<double, 3> operator()(const CylinderShape& cylinder) const {
      return {cylinder.radius_m, cylinder.length_m, 0};
    }
    std::array<double, 3> operator()(const SphereShape& sphere) const {
      return {sphere.radius_m, 0, 0};
    }
    std::array<double, 3> operator()(const CapsuleShape& capsule) const {
      return {capsule.radius_m, capsule.length_m, 0};
    }
  };
  return {shape.index(), std::visit(Sizes{}, shape)};
}

Shape to_shape(const ShapeNumbers& numbers) {
  const auto& [first, second, third] = numbers.sizes;
  switch (numbers.kind) {
    case 0:
      return BoxShape{{first, second, third}};
    case 1:
      return CylinderShape{first, second};
    case 2:
      return SphereShape{first};
    case 3:
      return CapsuleShape{first, second};
    default:
      throw std::invalid_argument("shape kind " + std::to_string(numbers.kind) + " exceeds 3");
  }
}

std::size_t scene_bytes(const RecordedScene& scene) {
  std::size_t bytes = kThingBytes * (scene.objects.size() + scene.held.size()) +
                      kPairBytes * scene.allowed_collisions.size() +
                      (scene.constraint ? kConstraintBytes : 0);
  for (const SceneObject& object : scene.objects)
    bytes += object.name.size();
  for (const HeldObject& held : scene.held)
    bytes += held.name.size();
  for (const auto& [first, second] : scene.allowed_collisions)
    bytes += first.size() + second.size();
  return bytes;
}

std::optional<Error> check_scene(const RecordedScene& scene) {
  if (auto error = too_many("objects", scene.objects.size(), kMaxSceneObjects))
    return error;
  if (auto error = too_many("held things", scene.held.size(), kMaxHeldObjects))
    return error;
  if (auto error = too_many("allowed pairs", scene.allowed_collisions.size(), kMaxAllowedPairs))
    return error;
  if (auto error = too_many("bytes", scene_bytes(scene), kMaxSceneBytes))
    return error;
  for (const SceneObject& object : scene.objects)
    if (auto error = check_thing(object.name, object.shape, object.T_task_object))
      return error;
  for (const HeldObject& held : scene.held)
    if (auto error = check_thing(held.name, held.shape, held.T_transfer_object))
      return error;
  if (scene.constraint)
    if (auto error = check_constraint(*scene.constraint))
      return error;
  return check_pairs(scene);
}

Digest content_digest(const RecordedScene& scene) {
  Sha256 hash;
  std::vector<Thing> things;
  for (const SceneObject& object : scene.objects)
    things.push_back(thing_of(object.name, object.shape, object.T_task_object, object.approximate));
  add(std::move(things), hash);
  things.clear();
  for (const HeldObject& held : scene.held)
    things.push_back(thing_of(held.name, held.shape, held.T_transfer_object, held.approximate));
  add(std::move(things), hash);
  std::set<Pair> pairs;
  for (const auto& [first, second] : scene.allowed_collisions)
    pairs.insert(std::minmax(first, second));
  hash.add(std::uint64_t{pairs.size()});
  for (const auto& [first, second] : pairs)
    hash.add(std::string_view(first)).add(std::string_view(second));
  add(scene.constraint, hash);
  return hash.finish();
}

}  // namespace kinship
