#include "robots/planning/path_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::planning {
namespace {

constexpr double kStepRounding = 1e-9;  // joint units

void check_arguments(const Eigen::MatrixXd& waypoints, double step) {
  if (waypoints.cols() < 1 || !(step > 0))
    throw std::invalid_argument("path: no waypoint, or a step that is not positive");
}

/// Whether waypoint `last` continues the even steps from `first` to the one after it.
bool continues(const Eigen::MatrixXd& waypoints, Eigen::Index first, Eigen::Index last,
               double step) {
  const auto count = static_cast<double>(last - first);
  const double distance = (waypoints.col(last) - waypoints.col(first)).norm();
  return (waypoints.col(last) -
          (waypoints.col(first) + count * (waypoints.col(first + 1) - waypoints.col(first))))
                 .norm() <= kStepRounding &&
         count_of_parts(distance, step) == last - first;
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

Eigen::Index count_of_parts(double distance, double step) {
  return std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(std::ceil((distance - kStepRounding) / step)));
}

Eigen::MatrixXd densified(const Eigen::MatrixXd& waypoints, double step) {
  check_arguments(waypoints, step);
  const Eigen::Index segments = waypoints.cols() - 1;
  const auto count_of = [&](Eigen::Index i) {
    return count_of_parts((waypoints.col(i + 1) - waypoints.col(i)).norm(), step);
  };
  Eigen::Index total = 1;
  for (Eigen::Index i = 0; i < segments; ++i)
    total += count_of(i);
  Eigen::MatrixXd dense(waypoints.rows(), total);
  Eigen::Index next = 0;
  dense.col(next++) = waypoints.col(0);
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Index count = count_of(i);
    for (Eigen::Index k = 1; k < count; ++k)
      dense.col(next++) =
          waypoints.col(i) + (waypoints.col(i + 1) - waypoints.col(i)) *
                                 (static_cast<double>(k) / static_cast<double>(count));
    dense.col(next++) = waypoints.col(i + 1);
  }
  return dense;
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

MiddlesFirst::MiddlesFirst(Eigen::Index parts) : parts_(parts) {
  while (stride_ < parts_)
    stride_ *= 2;
  stride_ /= 2;
  next_ = stride_;
}

Eigen::Index MiddlesFirst::next() {
  if (stride_ > 0 && next_ >= parts_) {
    stride_ /= 2;
    next_ = stride_;
  }
  const Eigen::Index current = stride_ > 0 ? next_ : 0;
  next_ += 2 * stride_;
  return current;
}

Eigen::MatrixXd middles_first(const Eigen::MatrixXd& line) {
  const Eigen::Index parts = line.cols() - 1;
  Eigen::MatrixXd ordered(line.rows(), std::max<Eigen::Index>(parts - 1, 0));
  MiddlesFirst middles(parts);
  for (Eigen::Index i = 0; i < ordered.cols(); ++i)
    ordered.col(i) = line.col(middles.next());
  return ordered;
}

double path_length(const Eigen::Ref<const Eigen::MatrixXd>& waypoints) {
  double length = 0;
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i)
    length += (waypoints.col(i) - waypoints.col(i - 1)).norm();
  return length;
}

double hand_length_m(const kinematics::Chain& chain, const Eigen::MatrixXd& waypoints) {
  const Eigen::MatrixXd dense = densified(waypoints, kMeasuredStep);
  Eigen::MatrixXd way(3, dense.cols());
  for (Eigen::Index i = 0; i < dense.cols(); ++i)
    way.col(i) = kinematics::T_base_transfer(chain, dense.col(i)).translation();
  return path_length(way);
}

}  // namespace kinship::planning
