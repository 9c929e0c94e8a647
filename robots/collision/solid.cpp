#include "robots/collision/solid.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <octomap/OcTree.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <string>
#include <utility>

#include "proto/types/failure.hpp"
#include "robots/collision/convex_distance.hpp"
#include "robots/geometry/fitted_shape.hpp"

namespace kinship::collision {
namespace {

constexpr double kRounding_m = 1e-9;  // of rounding

/// Cells a side so that the cells of a box are nearly cubes, and at most `most` in all.
std::array<int, 3> cells_of(const Eigen::Vector3d& size, int most) {
  std::array<int, 3> cells = {1, 1, 1};
  for (;;) {
    // The longest cell is halved first: it makes the spheres big.
    Eigen::Index axis = 0;
    Eigen::Vector3d(size.x() / cells[0], size.y() / cells[1], size.z() / cells[2]).maxCoeff(&axis);
    std::array<int, 3> more = cells;
    ++more[static_cast<std::size_t>(axis)];
    if (more[0] * more[1] * more[2] > most)
      return cells;
    cells = more;
  }
}

std::vector<CoverSphere> cover_box(const Eigen::Vector3d& size, int most) {
  const std::array<int, 3> cells = cells_of(size, most);
  const Eigen::Vector3d cell(size.x() / cells[0], size.y() / cells[1], size.z() / cells[2]);
  std::vector<CoverSphere> spheres;
  for (int x = 0; x < cells[0]; ++x)
    for (int y = 0; y < cells[1]; ++y)
      for (int z = 0; z < cells[2]; ++z) {
        const Eigen::Vector3d center =
            cell.cwiseProduct(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5)) - size / 2;
        spheres.push_back(
            {center, cell.norm() / 2 + kRounding_m, (size / 2 - center.cwiseAbs()).minCoeff()});
      }
  return spheres;
}

/// At least so many, but 1 to `most`; also of numbers that no int can hold.
int slices(double wanted, int most) {
  return static_cast<int>(std::clamp(std::ceil(wanted), 1.0, static_cast<double>(most)));
}

/// Slices along z, each within one sphere about its middle.
std::vector<CoverSphere> cover_cylinder(double radius_m, double length_m, int most) {
  const int count = slices(2 * length_m / radius_m, most);
  const double slice = length_m / count;
  std::vector<CoverSphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) * slice - length_m / 2;
    spheres.push_back({{0, 0, z},
                       std::hypot(slice / 2, radius_m) + kRounding_m,
                       std::min(radius_m, length_m / 2 - std::abs(z))});
  }
  return spheres;
}

/// Spheres from one end of the axis to the other, so close that they hold the space in between.
std::vector<CoverSphere> cover_capsule(double radius_m, double length_m, int most) {
  if (most == 1)
    return {{Eigen::Vector3d::Zero(), length_m / 2 + radius_m + kRounding_m, radius_m}};
  const int gaps = slices(2 * length_m / radius_m, most - 1);
  const double outer = std::hypot(length_m / gaps / 2, radius_m) + kRounding_m;
  std::vector<CoverSphere> spheres;
  for (int i = 0; i <= gaps; ++i)
    spheres.push_back({{0, 0, length_m * i / gaps - length_m / 2}, outer, radius_m});
  return spheres;
}

/// Triangles within one sphere, about the middle of their box.
struct Cluster {
  std::vector<Eigen::Matrix3d> triangles;
  Eigen::Vector3d center = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Zero();
  double radius_m = 0;

  explicit Cluster(std::vector<Eigen::Matrix3d> its) : triangles(std::move(its)) {
    Eigen::Vector3d low = triangles.front().col(0), high = low;
    for (const Eigen::Matrix3d& triangle : triangles) {
      low = low.cwiseMin(triangle.rowwise().minCoeff());
      high = high.cwiseMax(triangle.rowwise().maxCoeff());
    }
    center = (low + high) / 2;
    size = high - low;
    for (const Eigen::Matrix3d& triangle : triangles)
      radius_m = std::max(radius_m,
                          (triangle.colwise() - center).colwise().norm().maxCoeff() + kRounding_m);
  }
  bool operator<(const Cluster& other) const { return radius_m < other.radius_m; }
};

/// One triangle as the two that its longest side's middle makes of it.
std::vector<Eigen::Matrix3d> halved(const Eigen::Matrix3d& triangle) {
  Eigen::Index from = 0;
  double longest = -1;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double side = (triangle.col((i + 1) % 3) - triangle.col(i)).norm();
    if (side > longest) {
      longest = side;
      from = i;
    }
  }
  const Eigen::Index to = (from + 1) % 3;
  const Eigen::Vector3d middle = (triangle.col(from) + triangle.col(to)) / 2;
  Eigen::Matrix3d first = triangle, second = triangle;
  first.col(to) = middle;
  second.col(from) = middle;
  return {first, second};
}

/// Both halves along the longest side of the cluster's box.
std::pair<Cluster, Cluster> split(Cluster cluster) {
  std::vector<Eigen::Matrix3d>& all = cluster.triangles;
  if (all.size() == 1)
    all = halved(all.front());
  Eigen::Index axis = 0;
  cluster.size.maxCoeff(&axis);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end(),
                   [axis](const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
                     return a.row(axis).sum() < b.row(axis).sum();
                   });
  return {Cluster({all.begin(), middle}), Cluster({middle, all.end()})};
}

constexpr int kMaxCoverSpheres = 4;
constexpr int kMostOfAShape = 16, kMostOfASurface = 64;  // spheres that hold it closely
constexpr double kSlack_m = 1e-9;  // so that rounding never calls touching solids apart

std::shared_ptr<const fcl::CollisionGeometry<double>> make_geometry(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return std::make_shared<fcl::Box<double>>(box->size);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::make_shared<fcl::Cylinder<double>>(cylinder->radius_m, cylinder->length_m);
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return std::make_shared<fcl::Sphere<double>>(sphere->radius_m);
  const auto& capsule = std::get<CapsuleShape>(shape);
  return std::make_shared<fcl::Capsule<double>>(capsule.radius_m, capsule.length_m);
}

std::shared_ptr<const fcl::CollisionGeometry<double>> make_mesh(const Eigen::Matrix3Xd& triangles) {
  if (triangles.cols() == 0 || triangles.cols() % 3 != 0 || !triangles.allFinite())
    throw Failure(ErrorCode::InvalidInput, "mesh: " + std::to_string(triangles.cols()) +
                                               " corners are no triangles, or not finite");
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  mesh->beginModel(static_cast<int>(triangles.cols() / 3), static_cast<int>(triangles.cols()));
  for (Eigen::Index i = 0; i < triangles.cols(); i += 3)
    mesh->addTriangle(triangles.col(i), triangles.col(i + 1), triangles.col(i + 2));
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

/// \param voxels  in the solid's frame, which lies on a corner of their grid
std::shared_ptr<const fcl::CollisionGeometry<double>> make_octree(const Eigen::Matrix3Xd& voxels,
                                                                  double voxel_m) {
  auto tree = std::make_shared<octomap::OcTree>(voxel_m);
  for (const auto& voxel : voxels.colwise())
    if (tree->updateNode(voxel.x(), voxel.y(), voxel.z(), /*occupied=*/true, /*lazy_eval=*/true) ==
        nullptr)
      throw Failure(ErrorCode::InvalidInput,
                    "point cloud: a voxel lies farther than OctoMap's keys");
  tree->updateInnerOccupancy();
  auto octree = std::make_shared<fcl::OcTree<double>>(tree);
  octree->computeLocalAABB();
  return octree;
}

/// Spheres that hold the cubes of a block, in the frame of its centre.
std::vector<CoverSphere> cover_voxels(const geometry::VoxelBlock& block, double voxel_m) {
  std::vector<CoverSphere> spheres;
  for (const geometry::VoxelBlock& part :
       geometry::blocks_of(block.voxels, voxel_m, kMostOfASurface)) {
    const Eigen::Vector3d middle =
        (part.voxels.rowwise().minCoeff() + part.voxels.rowwise().maxCoeff()) / 2;
    const double farthest_m = (part.voxels.colwise() - middle).colwise().norm().maxCoeff();
    spheres.push_back(
        {middle - block.center, farthest_m + voxel_m * std::sqrt(3.0) / 2 + kSlack_m, 0});
  }
  return spheres;
}

/// Solid angle of a triangle seen from the origin, signed by its orientation, steradian.
double solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double length_a = a.norm(), length_b = b.norm(), length_c = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), length_a * length_b * length_c + a.dot(b) * length_c +
                                               b.dot(c) * length_a + c.dot(a) * length_b);
}

/// Distance of a point from a shape in whose frame it is given; 0 within it.
double distance_from(const Shape& shape, const Eigen::Vector3d& p) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return (p.cwiseAbs() - box->size / 2).cwiseMax(0).norm();
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::hypot(std::max(p.head<2>().norm() - cylinder->radius_m, 0.0),
                      std::max(std::abs(p.z()) - cylinder->length_m / 2, 0.0));
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return std::max(p.norm() - sphere->radius_m, 0.0);
  const auto& capsule = std::get<CapsuleShape>(shape);
  const double beyond = std::max(std::abs(p.z()) - capsule.length_m / 2, 0.0);
  return std::max(std::hypot(p.head<2>().norm(), beyond) - capsule.radius_m, 0.0);
}

/// Radius of the cross-section perpendicular to the longest axis `axis`.
double cross_radius(const Shape& shape, const Eigen::Vector3d& half, Eigen::Index axis) {
  if (std::holds_alternative<BoxShape>(shape) || axis != 2) {
    Eigen::Vector3d cross = half;
    cross[axis] = 0;
    return cross.norm();
  }
  return half.x();  // round about z
}

}  // namespace

std::vector<CoverSphere> cover_shape(const Shape& shape, int most) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return cover_box(box->size, most);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return cover_cylinder(cylinder->radius_m, cylinder->length_m, most);
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return {{Eigen::Vector3d::Zero(), sphere->radius_m + kRounding_m, sphere->radius_m}};
  const auto& capsule = std::get<CapsuleShape>(shape);
  return cover_capsule(capsule.radius_m, capsule.length_m, most);
}

std::vector<CoverSphere> cover_triangles(const Eigen::Matrix3Xd& triangles, int most) {
  std::vector<Eigen::Matrix3d> all;
  for (Eigen::Index i = 0; i + 2 < triangles.cols(); i += 3)
    all.emplace_back(triangles.middleCols<3>(i));
  std::priority_queue<Cluster> clusters;
  clusters.emplace(std::move(all));
  while (static_cast<int>(clusters.size()) < most) {
    auto [first, second] = split(clusters.top());
    clusters.pop();
    clusters.push(std::move(first));
    clusters.push(std::move(second));
  }
  std::vector<CoverSphere> spheres;
  for (; !clusters.empty(); clusters.pop())
    spheres.push_back({clusters.top().center, clusters.top().radius_m, 0,
                       clusters.top().triangles.front().rowwise().mean()});
  return spheres;
}

Solid::Solid(const Shape& shape, const Eigen::Matrix3Xd* triangles)
    : shape_(shape), is_hollow_(triangles != nullptr) {
  if (const auto why = geometry::broken_rule(shape))
    throw Failure(ErrorCode::InvalidInput, *why);
  geometry_ = triangles != nullptr ? make_mesh(*triangles) : make_geometry(shape);
  cover_ = std::make_shared<const std::vector<CoverSphere>>(
      is_hollow_ ? cover_triangles(*triangles, kMostOfASurface)
                 : cover_shape(shape, kMostOfAShape));
  if (triangles != nullptr)
    p_point_ = triangles->col(0);
  bound();
}

Solid::Solid(const geometry::VoxelBlock& block, double voxel_m)
    : shape_(BoxShape{block.size}),
      is_hollow_(true),
      cube_m_(voxel_m),
      cover_(std::make_shared<const std::vector<CoverSphere>>(cover_voxels(block, voxel_m))),
      geometry_(make_octree(block.voxels.colwise() - block.center, voxel_m)) {
  p_point_ = block.voxels.col(0) - block.center;
  bound();
}

std::vector<Eigen::AlignedBox3d> Solid::cubes() const {
  std::vector<Eigen::AlignedBox3d> boxes;
  if (const auto* tree = dynamic_cast<const fcl::OcTree<double>*>(geometry_.get()))
    for (const auto& [x, y, z, side, cost, threshold] : tree->toBoxes()) {
      const Eigen::Vector3d center(x, y, z), half = Eigen::Vector3d::Constant(side / 2);
      boxes.emplace_back(center - half, center + half);
    }
  return boxes;
}

void Solid::bound() {
  half_extents_m_ = geometry::half_extents_m(shape_);
  Eigen::Index axis = 2;
  if (!std::holds_alternative<SphereShape>(shape_))
    half_extents_m_.maxCoeff(&axis);
  const double half_length = half_extents_m_[axis];
  const double cross = cross_radius(shape_, half_extents_m_, axis);
  const bool round_ends =
      std::holds_alternative<SphereShape>(shape_) || std::holds_alternative<CapsuleShape>(shape_);
  radius_m_ = (round_ends ? half_length : std::hypot(half_length, cross)) + kSlack_m;

  // `count` slices along the longest axis, each within one sphere about the slice's centre.
  const int count =
      static_cast<int>(std::clamp(std::ceil(half_length / cross), 1.0, double{kMaxCoverSpheres}));
  cover_radius_m_ = count == 1 ? radius_m_ : std::hypot(half_length / count, cross) + kSlack_m;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    center[axis] = half_length * ((2 * i + 1.0) / count - 1);
    cover_centers_m_.push_back(center);
  }
}

bool Solid::cover_misses_box_of(const Solid& other, const Eigen::Isometry3d& T_other_this) const {
  const double limit = cover_radius_m_ * cover_radius_m_;
  return std::all_of(
      cover_centers_m_.begin(), cover_centers_m_.end(), [&](const Eigen::Vector3d& center) {
        const Eigen::Vector3d p = T_other_this * center;
        return (p.cwiseAbs() - other.half_extents_m_).cwiseMax(0).squaredNorm() > limit;
      });
}

double Solid::cover_distance_m(const Solid& other, const Eigen::Isometry3d& T_other_this) const {
  double least2 = std::numeric_limits<double>::max();
  for (const Eigen::Vector3d& center : cover_centers_m_) {
    const Eigen::Vector3d p = T_other_this * center;
    least2 = std::min(least2, (p.cwiseAbs() - other.half_extents_m_).cwiseMax(0).squaredNorm());
  }
  return std::sqrt(least2) - cover_radius_m_;
}

double Solid::close_cover_distance_m(const Solid& other,
                                     const Eigen::Isometry3d& T_other_this) const {
  double least = std::numeric_limits<double>::max();
  for (const CoverSphere& sphere : *cover_)
    least =
        std::min(least, distance_from(other.shape_, T_other_this * sphere.center) - sphere.outer_m);
  return least;
}

double cheap_distance_m(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
                        const Eigen::Isometry3d& T_base_b) {
  const double apart_m = (T_base_a.translation() - T_base_b.translation()).norm();
  const double spheres_m = apart_m - a.radius_m_ - b.radius_m_;
  const Eigen::Isometry3d T_a_b = T_base_a.inverse(Eigen::Isometry) * T_base_b;
  return std::max({0.0, spheres_m, b.cover_distance_m(a, T_a_b),
                   a.cover_distance_m(b, T_a_b.inverse(Eigen::Isometry))});
}

double close_distance_m(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
                        const Eigen::Isometry3d& T_base_b, double enough_m) {
  if (!a.is_hollow_ && !b.is_hollow_)
    return convex_distance_m(a.shape_, T_base_a, b.shape_, T_base_b, enough_m);
  const Eigen::Isometry3d T_a_b = T_base_a.inverse(Eigen::Isometry) * T_base_b;
  const double spheres_m =
      std::max(a.is_hollow_ ? a.close_cover_distance_m(b, T_a_b.inverse(Eigen::Isometry)) : 0.0,
               b.is_hollow_ ? b.close_cover_distance_m(a, T_a_b) : 0.0);
  if (spheres_m >= enough_m)
    return spheres_m;
  // FCL measures between two points that it found, so the solids may be a little nearer.
  constexpr double kRelative = 0.01, kAbsolute_m = 1e-4;
  static const fcl::DistanceRequest<double> kRequest = [] {
    fcl::DistanceRequest<double> request(/*enable_nearest_points_=*/false);
    request.gjk_solver_type = fcl::GST_LIBCCD;
    return request;
  }();
  if (touch(a, T_base_a, b, T_base_b))
    return 0;
  fcl::DistanceResult<double> result;
  fcl::distance(a.geometry_.get(), T_base_a, b.geometry_.get(), T_base_b, kRequest, result);
  return std::max((1 - kRelative) * result.min_distance - kAbsolute_m, spheres_m);
}

bool touch(const Solid& a, const Eigen::Isometry3d& T_base_a, const Solid& b,
           const Eigen::Isometry3d& T_base_b) {
  const double reach = a.radius_m_ + b.radius_m_;
  if ((T_base_a.translation() - T_base_b.translation()).squaredNorm() > reach * reach)
    return false;
  const Eigen::Isometry3d T_a_b = T_base_a.inverse(Eigen::Isometry) * T_base_b;
  if (b.cover_misses_box_of(a, T_a_b))
    return false;
  if (a.cover_misses_box_of(b, T_a_b.inverse(Eigen::Isometry)))
    return false;

  static const fcl::CollisionRequest<double> kRequest = [] {
    fcl::CollisionRequest<double> request(1, /*enable_contact_=*/false);
    request.gjk_solver_type = fcl::GST_LIBCCD;
    return request;
  }();
  fcl::CollisionResult<double> result;
  return fcl::collide(a.geometry_.get(), T_base_a, b.geometry_.get(), T_base_b, kRequest, result) >
         0;
}

bool encloses(const Solid& mesh, const Eigen::Isometry3d& T_base_mesh, const Solid& inner,
              const Eigen::Isometry3d& T_base_inner) {
  const auto* const surface =
      dynamic_cast<const fcl::BVHModel<fcl::OBBRSS<double>>*>(mesh.geometry_.get());
  if (surface == nullptr)
    return false;
  const Eigen::Vector3d p = T_base_mesh.inverse(Eigen::Isometry) * (T_base_inner * inner.p_point_);
  if ((p.cwiseAbs() - mesh.half_extents_m_).maxCoeff() > 0)
    return false;
  double angle = 0;
  for (int i = 0; i < surface->num_tris; ++i) {
    const fcl::Triangle& triangle = surface->tri_indices[i];
    angle += solid_angle(surface->vertices[triangle[0]] - p, surface->vertices[triangle[1]] - p,
                         surface->vertices[triangle[2]] - p);
  }
  return std::abs(angle) > 2 * std::numbers::pi;  // 4 pi within, 0 without
}

}  // namespace kinship::collision
