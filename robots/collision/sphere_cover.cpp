#include "robots/collision/sphere_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

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
    spheres.push_back({clusters.top().center, clusters.top().radius_m, 0});
  return spheres;
}

}  // namespace kinship::collision
