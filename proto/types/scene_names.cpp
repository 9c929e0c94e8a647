#include "proto/types/scene_names.hpp"

#include <algorithm>
#include <set>

namespace kinship {

bool has_object(const Scene& scene, std::string_view name) {
  const auto has_name = [&](const auto& object) { return object.name == name; };
  return std::ranges::any_of(scene.objects, has_name) ||
         std::ranges::any_of(scene.meshes, has_name) || std::ranges::any_of(scene.clouds, has_name);
}

std::optional<std::string> find_repeated_name(const Scene& scene) {
  std::set<std::string_view> names;
  std::optional<std::string> repeated;
  const auto add = [&](const auto& objects) {
    for (const auto& object : objects)
      if (!repeated && !names.insert(object.name).second)
        repeated = object.name;
  };
  add(scene.objects);
  add(scene.meshes);
  add(scene.clouds);
  return repeated;
}

}  // namespace kinship
