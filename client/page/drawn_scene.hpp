#pragma once

#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::page {

/// What view.js draws of a scene: its solids, and boxes around its meshes and point clouds.
/// \param scene  read (models::SceneMeshes); what has no triangles or voxels is left out.
std::vector<SceneObject> drawn_objects(const Scene& scene);

}  // namespace kinship::page
