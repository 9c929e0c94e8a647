#include "robots/geometry/fitted_shape.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace kinship::geometry {
namespace {

using Broken = std::optional<std::string>;

Broken check(const char* name, double value_m) {
  if (value_m > 0 && value_m <= kMaxShape_m)
    return std::nullopt;  // false for NaN
  std::ostringstream text;
  text << name << " of " << value_m << " m is not between 0 and " << kMaxShape_m << " m";
  return text.str();
}

struct Checker {
  Broken operator()(const BoxShape& box) const {
    for (const double extent : {box.size.x(), box.size.y(), box.size.z()})
      if (auto why = check("box extent", extent))
        return why;
    return std::nullopt;
  }
  Broken operator()(const CylinderShape& cylinder) const {
    if (auto why = check("cylinder radius", cylinder.radius_m))
      return why;
    return check("cylinder length", cylinder.length_m);
  }
  Broken operator()(const SphereShape& sphere) const {
    return check("sphere radius", sphere.radius_m);
  }
  Broken operator()(const CapsuleShape& capsule) const {
    if (auto why = check("capsule radius", capsule.radius_m))
      return why;
    if (capsule.length_m == 0)
      return std::nullopt;
    return check("capsule length", capsule.length_m);
  }
};

struct HalfExtents {
  Eigen::Vector3d operator()(const BoxShape& box) const { return box.size / 2; }
  Eigen::Vector3d operator()(const CylinderShape& cylinder) const {
    return {cylinder.radius_m, cylinder.radius_m, cylinder.length_m / 2};
  }
  Eigen::Vector3d operator()(const SphereShape& sphere) const {
    return Eigen::Vector3d::Constant(sphere.radius_m);
  }
  Eigen::Vector3d operator()(const CapsuleShape& capsule) const {
    return {capsule.radius_m, capsule.radius_m, capsule.length_m / 2 + capsule.radius_m};
  }
};

constexpr double kSlack_m = 1e-9;  // rounding must not leave a point outside

struct Candidate {
  FittedShape fitted;
  double volume_m3 = 0;
};

/// Right-handed axes, longest spread last, as columns.
Eigen::Matrix3d principal_axes(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Vector3d mean = points.rowwise().mean();
  const Eigen::Matrix3Xd centred = points.colwise() - mean;
  const Eigen::Matrix3d covariance = centred * centred.transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0)
    axes.col(0) = -axes.col(0);
  return axes;
}

/// Axes with `axes.col(last)` as z, right-handed.
Eigen::Matrix3d with_z(const Eigen::Matrix3d& axes, Eigen::Index last) {
  Eigen::Matrix3d turned;
  turned << axes.col((last + 1) % 3), axes.col((last + 2) % 3), axes.col(last);
  return turned;
}

Eigen::Isometry3d pose(const Eigen::Matrix3d& axes, const Eigen::Vector3d& p_axes_center) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = axes;
  T.translation() = axes * p_axes_center;
  return T;
}

Candidate fit_box(const Eigen::Ref<const Eigen::Matrix3Xd>& points, const Eigen::Matrix3d& axes) {
  const Eigen::Matrix3Xd turned = axes.transpose() * points;
  const Eigen::Vector3d low = turned.rowwise().minCoeff();
  const Eigen::Vector3d high = turned.rowwise().maxCoeff();
  const Eigen::Vector3d size = (high - low).cwiseMax(kMinFitted_m).array() + 2 * kSlack_m;
  return {{BoxShape{size}, pose(axes, (low + high) / 2)}, size.prod()};
}

/// A capsule along z of `axes`, about the middle of the points' extents across it.
Candidate fit_capsule(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      const Eigen::Matrix3d& axes) {
  Eigen::Matrix3Xd turned = axes.transpose() * points;
  Eigen::Vector3d center = (turned.rowwise().minCoeff() + turned.rowwise().maxCoeff()) / 2;
  turned.colwise() -= center;
  const Eigen::ArrayXd squared_m2 = turned.topRows<2>().colwise().squaredNorm();
  const double radius_m = std::max(std::sqrt(squared_m2.maxCoeff()), kMinFitted_m / 2) + kSlack_m;
  // A point at height z is inside if the end of the axis reaches z less covered_m.
  const Eigen::ArrayXd covered_m = (radius_m * radius_m - squared_m2).sqrt();
  const Eigen::ArrayXd z = turned.row(2).transpose();
  double top = (z - covered_m).maxCoeff(), bottom = (z + covered_m).minCoeff();
  if (top < bottom)
    top = bottom = (top + bottom) / 2;
  center.z() += (top + bottom) / 2;
  const double length_m = top - bottom + 2 * kSlack_m;
  const double volume_m3 =
      std::numbers::pi * radius_m * radius_m * (length_m + 4.0 / 3.0 * radius_m);
  return {{CapsuleShape{radius_m, length_m}, pose(axes, center)}, volume_m3};
}

/// Whether all triangles of a mesh are points or lines: there is nothing that could be touched.
bool has_no_area(const Eigen::Matrix3Xd& corners) {
  for (Eigen::Index i = 0; i < corners.cols(); i += 3) {
    const Eigen::Vector3d along = corners.col(i + 1) - corners.col(i);
    const Eigen::Vector3d across = corners.col(i + 2) - corners.col(i);
    if (along.cross(across).squaredNorm() > 0)
      return false;
  }
  return true;
}

}  // namespace

Broken broken_rule(const Shape& shape) { return std::visit(Checker{}, shape); }

Eigen::Vector3d half_extents_m(const Shape& shape) { return std::visit(HalfExtents{}, shape); }

FittedShape fit_shape(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  std::vector<Candidate> candidates;
  for (const Eigen::Matrix3d& axes :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), principal_axes(points)}) {
    candidates.push_back(fit_box(points, axes));
    for (Eigen::Index z = 0; z < 3; ++z)
      candidates.push_back(fit_capsule(points, with_z(axes, z)));
  }
  return std::min_element(
             candidates.begin(), candidates.end(),
             [](const Candidate& a, const Candidate& b) { return a.volume_m3 < b.volume_m3; })
      ->fitted;
}

Result<FittedMesh> fit_mesh(const Eigen::Matrix3Xd& corners) {
  if (corners.cols() == 0 || corners.cols() % 3 != 0)
    return Error{ErrorCode::InvalidInput,
                 std::to_string(corners.cols()) + " corners, which are no triangles"};
  if (!corners.allFinite())
    return Error{ErrorCode::InvalidInput, "a corner is not finite"};
  if (has_no_area(corners))
    return Error{ErrorCode::InvalidInput, "its triangles have no area"};
  const FittedShape fitted = fit_shape(corners);
  if (const auto why = broken_rule(fitted.shape))
    return Error{ErrorCode::InvalidInput, *why};
  const Eigen::Isometry3d T_shape_points = fitted.T_points_shape.inverse(Eigen::Isometry);
  return FittedMesh{fitted, std::make_shared<const Eigen::Matrix3Xd>(T_shape_points * corners)};
}

}  // namespace kinship::geometry
