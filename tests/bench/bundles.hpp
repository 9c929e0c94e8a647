#pragma once

#include <Eigen/Core>
#include <random>

namespace kinship::bench {

inline constexpr Eigen::Index kPointsPerBundlePath = 145;

/// Waypoints of curved bundles: 24 prototypes of cubic curves, paths of 145 points near them.
/// \return dimension x count.
inline Eigen::MatrixXd bundles(Eigen::Index count, Eigen::Index dimension = 7) {
  constexpr Eigen::Index kPrototypes = 24;
  constexpr Eigen::Index kControls = 4;
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd prototypes = Eigen::MatrixXd::NullaryExpr(
      dimension, kPrototypes * kControls, [&] { return uniform(generator); });
  Eigen::MatrixXd points(dimension, count);
  Eigen::MatrixXd controls(dimension, kControls);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index on_path = i % kPointsPerBundlePath;
    if (on_path == 0)
      controls =
          prototypes.middleCols(kControls * (i / kPointsPerBundlePath % kPrototypes), kControls) +
          0.15 *
              Eigen::MatrixXd::NullaryExpr(dimension, kControls, [&] { return normal(generator); });
    const double t = static_cast<double>(on_path) / static_cast<double>(kPointsPerBundlePath - 1);
    const double s = 1 - t;
    const Eigen::Vector4d bernstein(s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t);
    points.col(i) = controls * bernstein + 0.004 * Eigen::VectorXd::NullaryExpr(dimension, [&] {
                                             return normal(generator);
                                           });
  }
  return points;
}

}  // namespace kinship::bench
