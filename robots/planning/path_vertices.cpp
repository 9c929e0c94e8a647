#include "robots/planning/path_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace kinship::planning {
namespace {

constexpr double kStepRounding = 1e-9;  // joint units

/// Number of equal parts of at most `step` that a distance is cut into.
Eigen::Index parts(double distance, double step) {
  return std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(std::ceil((distance - kStepRounding) / step)));
}

void check_arguments(const Eigen::MatrixXd& waypoints, double step) {
  if (waypoints.cols() < 1 || !(step > 0))
    throw std::invalid_argument("path: no waypoint, or a step that is not positive");
}

/// Whether waypoint `last` continues the even steps from `first` to the one after it.
bool continues(const Eigen::MatrixXd& waypoints, Eigen::Index first, Eigen::Index last,
               double step) {
  const Eigen::VectorXd stride = waypoints.col(first + 1) - waypoints.col(first);
  const Eigen::Index count = last - first;
  const Eigen::VectorXd expected = waypoints.col(first) + static_cast<double>(count) * stride;
  const double distance = (waypoints.col(last) - waypoints.col(first)).norm();
  return (waypoints.col(last) - expected).norm() <= kStepRounding && parts(distance, step) == count;
}

Eigen::MatrixXd without_repetitions(const Eigen::MatrixXd& waypoints) {
  Eigen::MatrixXd kept(waypoints.rows(), waypoints.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i)
    if (count == 0 || waypoints.col(i) != kept.col(count - 1))
      kept.col(count++) = waypoints.col(i);
  return kept.leftCols(count);
}

}  // namespace

Eigen::MatrixXd densified(const Eigen::MatrixXd& waypoints, double step) {
  check_arguments(waypoints, step);
  std::vector<Eigen::VectorXd> dense = {waypoints.col(0)};
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i) {
    const Eigen::VectorXd from = waypoints.col(i - 1);
    const Eigen::VectorXd segment = waypoints.col(i) - from;
    const Eigen::Index count = parts(segment.norm(), step);
    for (Eigen::Index k = 1; k < count; ++k)
      dense.emplace_back(from + segment * (static_cast<double>(k) / static_cast<double>(count)));
    dense.emplace_back(waypoints.col(i));
  }
  Eigen::MatrixXd result(waypoints.rows(), static_cast<Eigen::Index>(dense.size()));
  for (std::size_t i = 0; i < dense.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = dense[i];
  return result;
}

Eigen::MatrixXd sparse_vertices(const Eigen::MatrixXd& waypoints, double step) {
  check_arguments(waypoints, step);
  const Eigen::MatrixXd dense = without_repetitions(waypoints);
  if (dense.cols() < 2)
    return waypoints.cols() < 2 ? waypoints : waypoints.leftCols(2);
  Eigen::MatrixXd vertices(dense.rows(), dense.cols());
  Eigen::Index count = 0, first = 0;
  vertices.col(count++) = dense.col(0);
  while (first + 1 < dense.cols()) {
    Eigen::Index last = first + 1;
    while (last + 1 < dense.cols() && continues(dense, first, last + 1, step))
      ++last;
    vertices.col(count++) = dense.col(last);
    first = last;
  }
  return vertices.leftCols(count);
}

double path_length(const Eigen::MatrixXd& waypoints) {
  double length = 0;
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i)
    length += (waypoints.col(i) - waypoints.col(i - 1)).norm();
  return length;
}

}  // namespace kinship::planning
