#include "robots/geometry/mesh_cover.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace kinship::geometry {
namespace {

constexpr double kTightSlack_m = 1e-9;  // rounding must not leave a point outside
constexpr int kBallSteps = 40;
constexpr int kDirections = 256, kFewDirections = 48;  // in which extreme points are looked for

enum class Kind { Box, Cylinder, Capsule };
constexpr std::array<Kind, 3> kKinds = {Kind::Box, Kind::Cylinder, Kind::Capsule};

struct TightShape {
  FittedShape fitted;
  double volume_m3 = std::numeric_limits<double>::infinity();
};

/// Near the centre of the smallest ball around points, rows x n.
template <int kRows>
Eigen::Matrix<double, kRows, 1> ball_center(
    const Eigen::Matrix<double, kRows, Eigen::Dynamic>& points) {
  Eigen::Matrix<double, kRows, 1> center =
      (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  for (int step = 1; step <= kBallSteps; ++step) {
    Eigen::Index farthest = 0;
    (points.colwise() - center).colwise().squaredNorm().maxCoeff(&farthest);
    center += (points.col(farthest) - center) / (step + 2.0);
  }
  return center;
}

Eigen::Isometry3d placed(const Eigen::Matrix3d& axes, const Eigen::Vector3d& p_axes_center) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = axes;
  T.translation() = axes * p_axes_center;
  return T;
}

TightShape sized(const Shape& shape, const Eigen::Isometry3d& T) {
  return {{shape, T}, volume_m3(shape)};
}

TightShape box_along(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                     const Eigen::Matrix3d& axes) {
  const Eigen::Matrix3Xd turned = axes.transpose() * points;
  const Eigen::Vector3d low = turned.rowwise().minCoeff(), high = turned.rowwise().maxCoeff();
  const Eigen::Vector3d size = (high - low).cwiseMax(kMinFitted_m).array() + 2 * kTightSlack_m;
  return sized(BoxShape{size}, placed(axes, (low + high) / 2));
}

/// A cylinder or capsule along z of `axes`.
TightShape round_along(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                       const Eigen::Matrix3d& axes, Kind kind) {
  Eigen::Matrix3Xd turned = axes.transpose() * points;
  Eigen::Vector3d center;
  center.head<2>() = ball_center<2>(turned.topRows<2>());
  center.z() = (turned.row(2).minCoeff() + turned.row(2).maxCoeff()) / 2;
  turned.colwise() -= center;
  const Eigen::ArrayXd squared_m2 = turned.topRows<2>().colwise().squaredNorm();
  const double radius_m =
      std::max(std::sqrt(squared_m2.maxCoeff()), kMinFitted_m / 2) + kTightSlack_m;
  const Eigen::ArrayXd z = turned.row(2).transpose();
  if (kind == Kind::Cylinder) {
    const double length_m = std::max(2 * z.abs().maxCoeff(), kMinFitted_m) + 2 * kTightSlack_m;
    return sized(CylinderShape{radius_m, length_m}, placed(axes, center));
  }
  // A point at height z is inside if the end of the axis reaches z less covered_m.
  const Eigen::ArrayXd covered_m = (radius_m * radius_m - squared_m2).max(0.0).sqrt();
  double top = (z - covered_m).maxCoeff(), bottom = (z + covered_m).minCoeff();
  if (top < bottom)
    top = bottom = (top + bottom) / 2;
  center.z() += (top + bottom) / 2;
  return sized(CapsuleShape{radius_m, top - bottom + 2 * kTightSlack_m}, placed(axes, center));
}

TightShape along(const Eigen::Ref<const Eigen::Matrix3Xd>& points, const Eigen::Matrix3d& axes,
                 Kind kind) {
  return kind == Kind::Box ? box_along(points, axes) : round_along(points, axes, kind);
}

TightShape sphere_around(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Vector3d center = ball_center<3>(points);
  const double radius_m = std::sqrt((points.colwise() - center).colwise().squaredNorm().maxCoeff());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = center;
  return sized(SphereShape{std::max(radius_m, kMinFitted_m / 2) + kTightSlack_m}, T);
}

/// Right-handed, as columns; the identity of a single point.
Eigen::Matrix3d spread_axes(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean().eval();
  const Eigen::Matrix3d covariance = centred * centred.transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0)
    axes.col(0) = -axes.col(0);
  return axes;
}

struct Choice {
  Kind kind = Kind::Box;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double volume_m3 = std::numeric_limits<double>::infinity();
};

/// Every kind along every axis of the frame and of the spread, the best of each kind.
std::array<Choice, 3> first_choices(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  std::array<Choice, 3> best;
  for (const Eigen::Matrix3d& axes :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), spread_axes(points)})
    for (std::size_t k = 0; k < kKinds.size(); ++k)
      for (Eigen::Index last = 0; last < (kKinds.at(k) == Kind::Box ? 1 : 3); ++last) {
        Eigen::Matrix3d turned;
        turned << axes.col((last + 1) % 3), axes.col((last + 2) % 3), axes.col(last);
        const double volume = along(points, turned, kKinds.at(k)).volume_m3;
        if (volume < best.at(k).volume_m3)
          best.at(k) = {kKinds.at(k), turned, volume};
      }
  return best;
}

/// Turns the axes by smaller and smaller steps while the volume falls.
void turn(const Eigen::Matrix3Xd& points, Choice& choice) {
  constexpr double kLargest_rad = 0.4, kSmallest_rad = 0.005;
  for (double step_rad = kLargest_rad; step_rad > kSmallest_rad; step_rad /= 2) {
    bool is_better = true;
    for (int rounds = 0; is_better && rounds < 4; ++rounds) {
      is_better = false;
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
          const Eigen::Matrix3d axes =
              choice.axes *
              Eigen::AngleAxisd(sign * step_rad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
          const double volume = along(points, axes, choice.kind).volume_m3;
          if (volume < choice.volume_m3 * (1 - 1e-6)) {
            choice = {choice.kind, axes, volume};
            is_better = true;
          }
        }
    }
  }
}

/// The points farthest in each of many directions: they nearly decide how large a solid has to be.
Eigen::Matrix3Xd extreme_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int directions) {
  if (points.cols() <= directions)
    return points;
  std::vector<Eigen::Index> kept;
  constexpr double kGoldenAngle_rad = 2.399963229728653;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, r = std::sqrt(1 - z * z);
    const Eigen::Vector3d direction(r * std::cos(kGoldenAngle_rad * i),
                                    r * std::sin(kGoldenAngle_rad * i), z);
    Eigen::Index farthest = 0;
    (direction.transpose() * points).maxCoeff(&farthest);
    kept.push_back(farthest);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  Eigen::Matrix3Xd extreme(3, static_cast<Eigen::Index>(kept.size()));
  for (Eigen::Index i = 0; i < extreme.cols(); ++i)
    extreme.col(i) = points.col(kept[static_cast<std::size_t>(i)]);
  return extreme;
}

FittedShape smallest(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                     const std::array<Choice, 3>& choices) {
  TightShape best = sphere_around(points);
  for (const Choice& choice : choices) {
    TightShape shape = along(points, choice.axes, choice.kind);
    if (shape.volume_m3 < best.volume_m3)
      best = std::move(shape);
  }
  return best.fitted;
}

constexpr Eigen::Index kTrialTriangles = 300;  // of a piece, by which cuts are compared
constexpr std::array<double, 5> kCuts = {0.2, 0.35, 0.5, 0.65, 0.8};  // of a solid's extent

/// Triangles, cut by the plane normal . p = offset into triangles on either side.
class Pieces {
 public:
  Pieces(Eigen::Vector3d normal, double offset_m) : normal_(std::move(normal)), offset_(offset_m) {}

  void add(const Eigen::Ref<const Eigen::Matrix3d>& triangle) {
    const Eigen::Vector3d height = (normal_.transpose() * triangle).array() - offset_;
    for (const double side : {1.0, -1.0})
      add_side(triangle, side * height, side > 0 ? above_ : below_);
  }

  Eigen::Matrix3Xd above() const { return matrix(above_); }
  Eigen::Matrix3Xd below() const { return matrix(below_); }

 private:
  using Points = std::vector<Eigen::Vector3d>;

  /// The part where the height is not negative, as a fan. (Sutherland and Hodgman, 1974.)
  static void add_side(const Eigen::Ref<const Eigen::Matrix3d>& triangle,
                       const Eigen::Vector3d& height, Points& side) {
    std::array<Eigen::Vector3d, 4> polygon;
    std::size_t corners = 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index j = (i + 1) % 3;
      if (height[i] >= 0)
        polygon.at(corners++) = triangle.col(i);
      if ((height[i] > 0 && height[j] < 0) || (height[i] < 0 && height[j] > 0))
        polygon.at(corners++) = triangle.col(i) + height[i] / (height[i] - height[j]) *
                                                      (triangle.col(j) - triangle.col(i));
    }
    for (std::size_t k = 2; k < corners; ++k)
      side.insert(side.end(), {polygon[0], polygon.at(k - 1), polygon.at(k)});
  }

  static Eigen::Matrix3Xd matrix(const Points& points) {
    return points.empty()
               ? Eigen::Matrix3Xd(3, 0)
               : Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(
                     points.front().data(), 3, static_cast<Eigen::Index>(points.size())));
  }

  Eigen::Vector3d normal_;
  double offset_;
  Points above_, below_;
};

Pieces cut(const Eigen::Matrix3Xd& corners, const Eigen::Vector3d& normal, double offset_m,
           Eigen::Index stride = 1) {
  Pieces pieces(normal, offset_m);
  for (Eigen::Index i = 0; i < corners.cols(); i += 3 * stride)
    pieces.add(corners.middleCols<3>(i));
  return pieces;
}

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double offset_m = 0;
  double gain_m3 = -std::numeric_limits<double>::infinity();  ///< that the cut promises
};

/// A piece of the mesh, its solid and where it would be cut best.
struct Piece {
  Eigen::Matrix3Xd corners;
  FittedShape shape;
  Plane best;
};

double quick_volume_m3(const Eigen::Matrix3Xd& corners) {
  return volume_m3(fit_quickly(corners).shape);
}

/// The axes of a solid and of the mesh, if they differ.
std::vector<Eigen::Matrix3d> axes_of(const FittedShape& shape) {
  std::vector<Eigen::Matrix3d> axes = {shape.T_points_shape.linear()};
  constexpr double kAlike = 1e-6;
  if (!axes.front().isIdentity(kAlike))
    axes.emplace_back(Eigen::Matrix3d::Identity());
  return axes;
}

Plane best_cut(const Eigen::Matrix3Xd& corners, const FittedShape& shape) {
  const Eigen::Index stride = 1 + corners.cols() / 3 / kTrialTriangles;
  const double whole_m3 = volume_m3(shape.shape);
  Plane best;
  for (const Eigen::Matrix3d& axes : axes_of(shape))
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d normal = axes.col(axis);
      const Eigen::RowVectorXd heights = normal.transpose() * corners;
      const double low = heights.minCoeff(), extent = heights.maxCoeff() - low;
      for (const double part : kCuts) {
        const Pieces pieces = cut(corners, normal, low + part * extent, stride);
        const Eigen::Matrix3Xd above = pieces.above(), below = pieces.below();
        if (above.cols() == 0 || below.cols() == 0)
          continue;
        const double gain_m3 = whole_m3 - quick_volume_m3(above) - quick_volume_m3(below);
        if (gain_m3 > best.gain_m3)
          best = {normal, low + part * extent, gain_m3};
      }
    }
  return best;
}

Piece make_piece(Eigen::Matrix3Xd corners, bool may_be_cut) {
  Piece piece{std::move(corners), {}, {}};
  piece.shape = fit_tightly(piece.corners);
  if (may_be_cut)
    piece.best = best_cut(piece.corners, piece.shape);
  return piece;
}

double total_m3(const std::vector<Piece>& pieces) {
  double total = 0;
  for (const Piece& piece : pieces)
    total += volume_m3(piece.shape.shape);
  return total;
}

/// Whether a point in the frame of a shape is in it.
struct Inside {
  Eigen::Vector3d p;

  bool operator()(const BoxShape& box) const {
    return (2 * p.cwiseAbs().array() <= box.size.array()).all();
  }
  bool operator()(const SphereShape& sphere) const { return p.norm() <= sphere.radius_m; }
  bool operator()(const CylinderShape& cylinder) const {
    return p.head<2>().norm() <= cylinder.radius_m && 2 * std::abs(p.z()) <= cylinder.length_m;
  }
  bool operator()(const CapsuleShape& capsule) const {
    const double beyond = std::max(std::abs(p.z()) - capsule.length_m / 2, 0.0);
    return std::hypot(p.head<2>().norm(), beyond) <= capsule.radius_m;
  }
};

/// Solids that are asked for the triangles of one mesh.
class Holders {
 public:
  /// \param tests_left  how often a point may be looked for in a solid; counted down.
  Holders(const std::vector<FittedShape>& solids, std::size_t& tests_left)
      : tests_left_(tests_left) {
    for (const FittedShape& solid : solids)
      solids_.push_back({grown(solid.shape, kCoverMargin_m), solid.T_points_shape.inverse()});
  }

  /// Halves what no single solid holds: each is convex. A piece as short as the margin lies in
  /// every solid that one of its points was in before that grew.
  bool hold(const Eigen::Matrix3d& triangle) {
    std::vector<Eigen::Matrix3d> open = {triangle};
    while (!open.empty()) {
      const Eigen::Matrix3d piece = open.back();
      open.pop_back();
      if (is_in_one(piece))
        continue;
      Eigen::Index longest = 0;
      const Eigen::Vector3d edges((piece.col(1) - piece.col(0)).norm(),
                                  (piece.col(2) - piece.col(1)).norm(),
                                  (piece.col(0) - piece.col(2)).norm());
      if (edges.maxCoeff(&longest) <= kCoverMargin_m || tests_left_ == 0)
        return false;
      const Eigen::Index next = (longest + 1) % 3;
      const Eigen::Vector3d middle = (piece.col(longest) + piece.col(next)) / 2;
      open.insert(open.end(), 2, piece);
      open[open.size() - 2].col(longest) = middle;
      open.back().col(next) = middle;
    }
    return true;
  }

 private:
  /// Neighbours of a triangle are likely in the same solid: that is asked first.
  bool is_in_one(const Eigen::Matrix3d& piece) {
    for (std::size_t i = 0; i < solids_.size() && tests_left_ > 0; ++i) {
      const std::size_t at = (last_ + i) % solids_.size();
      const auto& [shape, T_shape_points] = solids_[at];
      bool is_inside = true;
      for (Eigen::Index corner = 0; is_inside && corner < 3; ++corner)
        is_inside = tests_left_ > 0 && tests_left_-- > 0 &&
                    std::visit(Inside{T_shape_points * piece.col(corner)}, shape);
      if (is_inside) {
        last_ = at;
        return true;
      }
    }
    return false;
  }

  std::vector<std::pair<Shape, Eigen::Isometry3d>> solids_;
  std::size_t& tests_left_;
  std::size_t last_ = 0;
};

}  // namespace

double volume_m3(const Shape& shape) {
  struct Volume {
    double operator()(const BoxShape& box) const { return box.size.prod(); }
    double operator()(const CylinderShape& cylinder) const {
      return std::numbers::pi * cylinder.radius_m * cylinder.radius_m * cylinder.length_m;
    }
    double operator()(const SphereShape& sphere) const {
      return 4.0 / 3.0 * std::numbers::pi * std::pow(sphere.radius_m, 3);
    }
    double operator()(const CapsuleShape& capsule) const {
      return (*this)(CylinderShape{capsule.radius_m, capsule.length_m}) +
             (*this)(SphereShape{capsule.radius_m});
    }
  };
  return std::visit(Volume{}, shape);
}

FittedShape fit_quickly(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Matrix3Xd extreme = extreme_points(points, kFewDirections);
  return smallest(extreme, first_choices(extreme));
}

FittedShape fit_tightly(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Matrix3Xd extreme = extreme_points(points, kDirections);
  std::array<Choice, 3> choices = first_choices(extreme);
  for (Choice& choice : choices)
    turn(extreme, choice);
  return smallest(points, choices);
}

Shape grown(const Shape& shape, double by_m) {
  struct Grown {
    double by_m;
    Shape operator()(const BoxShape& box) const { return BoxShape{box.size.array() + 2 * by_m}; }
    Shape operator()(const CylinderShape& cylinder) const {
      return CylinderShape{cylinder.radius_m + by_m, cylinder.length_m + 2 * by_m};
    }
    Shape operator()(const SphereShape& sphere) const {
      return SphereShape{sphere.radius_m + by_m};
    }
    Shape operator()(const CapsuleShape& capsule) const {
      return CapsuleShape{capsule.radius_m + by_m, capsule.length_m};
    }
  };
  return std::visit(Grown{by_m}, shape);
}

bool hold(const std::vector<FittedShape>& solids, const Eigen::Matrix3Xd& corners,
          std::size_t& tests_left) {
  Holders holders(solids, tests_left);
  for (Eigen::Index i = 0; i < corners.cols(); i += 3)
    if (!holders.hold(corners.middleCols<3>(i)))
      return false;
  return true;
}

std::vector<FittedShape> cover_mesh(const Eigen::Matrix3Xd& corners, const CoverOptions& options) {
  std::vector<Piece> pieces;
  pieces.push_back(make_piece(corners, options.max_shapes > 1));
  while (std::ssize(pieces) < options.max_shapes) {
    const auto next = std::max_element(
        pieces.begin(), pieces.end(),
        [](const Piece& a, const Piece& b) { return a.best.gain_m3 < b.best.gain_m3; });
    if (next->best.gain_m3 < options.min_gain * total_m3(pieces))
      break;
    const Pieces halves = cut(next->corners, next->best.normal, next->best.offset_m);
    const bool may_be_cut = std::ssize(pieces) + 1 < options.max_shapes;
    Piece above = make_piece(halves.above(), may_be_cut);
    Piece below = make_piece(halves.below(), may_be_cut);
    *next = std::move(above);
    pieces.push_back(std::move(below));
  }
  std::vector<FittedShape> shapes;
  for (const Piece& piece : pieces)
    shapes.push_back(piece.shape);
  return shapes;
}

}  // namespace kinship::geometry
