#include "robots/geometry/mesh_cover.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "robots/geometry/tight_fit.hpp"

namespace kinship::geometry {
namespace {

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

}  // namespace

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
