#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "proto/types/scene.hpp"

/// Names of a scene's objects, by which contacts are told and allowed: each has one of its own.
namespace kinship {

bool has_object(const Scene& scene, std::string_view name);

/// A name that two objects of a scene have; nothing if there is none.
std::optional<std::string> find_repeated_name(const Scene& scene);

}  // namespace kinship
