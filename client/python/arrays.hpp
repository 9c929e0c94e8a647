#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

/// Values between numpy and the libraries. numpy arrays hold a configuration per row, the libraries
/// one per column: the bytes are the same.
namespace kinship::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Configurations given as one (dof numbers) or as rows (n x dof).
struct Configurations {
  Eigen::MatrixXd columns;  ///< dof x n
  bool is_one = false;
};

/// \param what  the owner of the joints, for messages.
/// \throws std::invalid_argument if their number of joints differs or there are other dimensions.
Configurations read_configurations(const Array& q, Eigen::Index dof, std::string_view what);

/// n x dof of dof x n.
Array to_rows(const Eigen::Ref<const Eigen::MatrixXd>& columns);
Array to_vector(const Eigen::Ref<const Eigen::VectorXd>& values);

/// A pose given as a 4 x 4 matrix or as x y z qx qy qz qw.
/// \param name  of the argument, for messages.
/// \throws Failure(InvalidInput) if it is no proper pose.
Eigen::Isometry3d read_pose(const Array& pose, std::string_view name);
std::optional<Eigen::Isometry3d> read_pose(const std::optional<Array>& pose, std::string_view name);

Array to_matrix(const Eigen::Isometry3d& T);  ///< 4 x 4
std::optional<Array> to_matrix(const std::optional<Eigen::Isometry3d>& T);

/// \throws std::invalid_argument unless 0 <= seconds <= a year.
std::chrono::milliseconds to_milliseconds(double seconds, std::string_view name);

}  // namespace kinship::python
