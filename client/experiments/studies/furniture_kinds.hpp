#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// What the furniture of a study is.
enum class FurnitureKind { Shelf, TallShelf, Box, Cage, Table };

/// From where a hand takes what stands on a board.
enum class Approach { Forward, Downward };

/// Where things stand.
struct Board {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of its top, m
  double half_x = 0, half_y = 0;                     ///< m, to where the middle of a thing may be
  Approach approach = Approach::Forward;
};

/// A piece of furniture in its own frame: origin on the floor below its middle, x from who stands
/// before it to its back, y to the left, z up.
struct Furniture {
  std::vector<SceneObject> solids;
  std::vector<Board> boards;
  double nominal_x = 0;    ///< m, before the robots: where its origin stands in the task frame
  std::size_t things = 0;  ///< that stand on its boards besides the one to grasp
};

Furniture make_furniture(FurnitureKind kind);

/// Of the study and its task, e.g. "furniture_tall_shelf".
std::string_view study_name(FurnitureKind kind);

}  // namespace kinship::experiments
