#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "proto/types/scene.hpp"
#include "robots/geometry/point_cloud.hpp"

namespace fcl {
template <typename S>
class CollisionGeometry;
}
namespace kinship::collision {

/// One of the spheres that together hold a solid.
struct CoverSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in the solid's frame, m
  double outer_m = 0;              ///< the spheres of these radii hold all of the solid
  double inner_m = 0;              ///< the sphere of this radius is within the solid; 0: unknown
  Eigen::Vector3d point = center;  ///< that belongs to the solid; of cubes any
};

/// Spheres that hold every point of a shape; a thin one needs many to be held closely.
/// \param most  of them, >= 1
std::vector<CoverSphere> cover_shape(const Shape& shape, int most);

/// Spheres that hold every point of triangles. Their inner radii are 0.
/// \param triangles  3 x 3 n, m, three columns per triangle, n >= 1
/// \param most       of them, >= 1
std::vector<CoverSphere> cover_triangles(const Eigen::Matrix3Xd& triangles, int most);

/// A shape prepared for many checks: covering spheres and its own bounding box, both of which show
/// "apart" cheaply, and FCL's geometry for the other cases. Immutable, cheap to copy.
///
/// For a mesh, the shape only bounds its extent, and the triangles are checked for contact: a solid
/// wholly within a closed mesh does not touch it.
class Solid {
 public:
  /// \param triangles  null, or a mesh within the shape, in its frame: 3 x 3 n, three columns a
  ///                   triangle, n >= 1. Copied.
  /// \throws Failure(InvalidInput) if a size is not finite and positive, or the triangles are
  ///         invalid.
  explicit Solid(const Shape& shape, const Eigen::Matrix3Xd* triangles = nullptr);

  /// The cubes of a block of a point cloud, each of them solid; the solid's frame is at the centre
  /// of the block's box.
  /// \param voxel_m  edge of a cube
  Solid(const geometry::VoxelBlock& block, double voxel_m);

  const Shape& shape() const noexcept { return shape_; }  ///< holds all of the solid
  bool is_hollow() const noexcept { return is_hollow_; }  ///< triangles or cubes within the shape
  /// Radius of the sphere about the centre that holds all of the solid.
  double radius_m() const noexcept { return radius_m_; }
  /// Half extents of the box about the centre that holds all of the solid.
  const Eigen::Vector3d& half_extents_m() const noexcept { return half_extents_m_; }
  /// Spheres that together hold all of the solid closely.
  const std::vector<CoverSphere>& cover() const noexcept { return *cover_; }

  /// Of a block of a point cloud: its cubes, several that fill a larger one as that, in the
  /// solid's frame, with corners at multiples of cube_m(). Of others empty.
  std::vector<Eigen::AlignedBox3d> cubes() const;
  double cube_m() const noexcept { return cube_m_; }  ///< edge of a cube; 0: there are none

  /// Whether two solids share a point, given their poses in one frame.
  friend bool touch(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
                    const Eigen::Isometry3d& T_base_b);

  /// Whether the surface of `mesh` is closed around `inner`, which must not touch it; false if
  /// `mesh` is no mesh. Of nested surfaces the innermost decides.
  /// Source: van Oosterom and Strackee, The Solid Angle of a Plane Triangle (1983), eq. 8; summed
  /// up it is the winding number of the surface around a point.
  friend bool encloses(const Solid& mesh, const Eigen::Isometry3d& T_base_mesh, const Solid& inner,
                       const Eigen::Isometry3d& T_base_inner);

  /// A lower bound on the distance of two solids, from spheres and boxes that hold them; 0:
  /// unknown.
  friend double cheap_distance_m(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
                                 const Eigen::Isometry3d& T_base_b);

  /// Lower bound on the distance of two solids: at most 1 % and 0.1 mm less than the distance; 0
  /// where they touch. Of shapes by convex_distance_m, of triangles and cubes by FCL.
  /// \param enough_m  a bound that reaches this need not be so tight
  friend double close_distance_m(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
                                 const Eigen::Isometry3d& T_base_b, double enough_m);

 private:
  void bound();  ///< by its shape
  /// Lower bound on the distance of this solid's covering spheres from the bounding box of `other`.
  double cover_distance_m(const Solid& other, const Eigen::Isometry3d& T_other_this) const;
  /// Lower bound on the distance of this solid's close cover from `other`'s shape.
  double close_cover_distance_m(const Solid& other, const Eigen::Isometry3d& T_other_this) const;
  /// Whether this solid's covering spheres miss the bounding box of `other`.
  bool cover_misses_box_of(const Solid& other, const Eigen::Isometry3d& T_other_this) const;

  Shape shape_;
  bool is_hollow_ = false;
  double cube_m_ = 0;
  double radius_m_ = 0;
  Eigen::Vector3d half_extents_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_point_ = Eigen::Vector3d::Zero();  // one that belongs to the solid
  std::vector<Eigen::Vector3d> cover_centers_m_;       // along the longest axis
  double cover_radius_m_ = 0;
  std::shared_ptr<const std::vector<CoverSphere>> cover_;
  std::shared_ptr<const fcl::CollisionGeometry<double>> geometry_;  // shared by copies, immutable
};

}  // namespace kinship::collision
