#pragma once

#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::page {

/// The objects of a scene that view.js draws: its solids, and boxes around its meshes and point
/// clouds.
/// \param scene  read (models::SceneMeshes); objects without triangles or voxels are left out.
std::vector<SceneObject> drawn_objects(const Scene& scene);

}  // namespace kinship::page
