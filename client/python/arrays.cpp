#include "client/python/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"

namespace kinship::python {
namespace {

constexpr py::ssize_t kPoseNumbers = 7;
constexpr py::ssize_t kMatrixRows = 4;
constexpr double kRotationTolerance = 1e-3;  // as from_pose_array's of a quaternion

std::string shape_text(const Array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// \throws std::invalid_argument unless the matrix is a rotation and a translation.
Eigen::Isometry3d from_matrix(const double* rows, std::string_view name) {
  using RowMajor4d = Eigen::Matrix<double, kMatrixRows, kMatrixRows, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor4d> matrix(rows);
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_rotation = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() <=
                               kRotationTolerance &&
                           rotation.determinant() > 0;
  if (!is_rotation || !(matrix.row(3) - Eigen::RowVector4d::UnitW()).isZero(kRotationTolerance))
    throw std::invalid_argument(std::string(name) +
                                ": the matrix is no rotation with a translation");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  T.translation() = matrix.topRightCorner<3, 1>();
  return T;
}

}  // namespace

Configurations read_configurations(const Array& q, Eigen::Index dof, std::string_view what) {
  const bool is_one = q.ndim() == 1;
  if ((!is_one && q.ndim() != 2) || q.shape(q.ndim() - 1) != dof)
    throw std::invalid_argument("configurations of shape " + shape_text(q) + ": " +
                                std::string(what) + " has " + std::to_string(dof) +
                                " joints, so (" + std::to_string(dof) + ",) or (n, " +
                                std::to_string(dof) + ") is wanted");
  const Eigen::Index count = is_one ? 1 : q.shape(0);
  return {Eigen::Map<const Eigen::MatrixXd>(q.data(), dof, count), is_one};
}

Array to_rows(const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  Array rows({columns.cols(), columns.rows()});
  Eigen::Map<Eigen::MatrixXd>(rows.mutable_data(), columns.rows(), columns.cols()) = columns;
  return rows;
}

Array to_vector(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Array vector(values.size());
  Eigen::Map<Eigen::VectorXd>(vector.mutable_data(), values.size()) = values;
  return vector;
}

Eigen::Isometry3d read_pose(const Array& pose, std::string_view name) {
  const bool is_matrix =
      pose.ndim() == 2 && pose.shape(0) == kMatrixRows && pose.shape(1) == kMatrixRows;
  if (!is_matrix && (pose.ndim() != 1 || pose.shape(0) != kPoseNumbers))
    throw std::invalid_argument(std::string(name) + ": shape " + shape_text(pose) +
                                ", must be (4, 4) or (7,): x y z qx qy qz qw");
  PoseArray numbers{};
  if (is_matrix)
    numbers = to_pose_array(from_matrix(pose.data(), name));
  else
    std::copy_n(pose.data(), numbers.size(), numbers.begin());
  Result<Eigen::Isometry3d> T = from_pose_array(numbers);
  if (!T)
    throw std::invalid_argument(std::string(name) + ": " + T.error().message);
  return *T;
}

std::optional<Eigen::Isometry3d> read_pose(const std::optional<Array>& pose,
                                           std::string_view name) {
  return pose ? std::optional(read_pose(*pose, name)) : std::nullopt;
}

Array to_matrix(const Eigen::Isometry3d& T) {
  Array matrix({kMatrixRows, kMatrixRows});
  Eigen::Map<Eigen::Matrix4d>(matrix.mutable_data()) = T.matrix().transpose();
  return matrix;
}

std::optional<Array> to_matrix(const std::optional<Eigen::Isometry3d>& T) {
  return T ? std::optional(to_matrix(*T)) : std::nullopt;
}

std::chrono::milliseconds to_milliseconds(double seconds, std::string_view name) {
  constexpr double kYear_s = 31'536'000;
  constexpr double kMilliseconds = 1000;
  if (!(seconds >= 0 && seconds <= kYear_s))
    throw std::invalid_argument(std::string(name) + ": " + number_text(seconds) +
                                " s, must be from 0 to a year");
  return std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(kMilliseconds * seconds)));
}

}  // namespace kinship::python
