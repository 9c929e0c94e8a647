#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kinship::store {

static_assert(std::endian::native == std::endian::little, "blobs hold little-endian numbers");

/// Appends values to a blob: numbers little-endian, texts and matrices after their sizes.
class ByteWriter {
 public:
  ByteWriter& add(std::uint64_t value);
  ByteWriter& add(double value);
  ByteWriter& add(std::string_view text);
  ByteWriter& add(std::span<const std::uint8_t> bytes);              ///< without a size
  ByteWriter& add(const Eigen::Ref<const Eigen::MatrixXd>& values);  ///< rows, cols, column-major
  ByteWriter& add(const std::optional<Eigen::Isometry3d>& T_a_b);    ///< flag, then 7 numbers

  const std::vector<std::uint8_t>& bytes() const noexcept { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Takes values from a blob in the order in which they were added. Every size is checked against a
/// limit and against the bytes left before any allocation. Every method throws std::out_of_range if
/// the blob does not hold the value.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::uint64_t integer();
  std::size_t integer(std::size_t max);  ///< refuses a greater one
  double real();
  std::string text(std::size_t max_size);
  void bytes(std::span<std::uint8_t> out);
  Eigen::MatrixXd matrix(std::size_t max_rows, std::size_t max_cols);
  std::optional<Eigen::Isometry3d> pose();
  Eigen::Isometry3d bare_pose();  ///< added as pose_blob(), without a flag
  bool at_end() const noexcept { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> take(std::size_t size);

  std::span<const std::uint8_t> rest_;
};

/// A pose as the database keeps it: 7 float64, x y z and the quaternion x y z w.
std::vector<std::uint8_t> pose_blob(const Eigen::Isometry3d& T_a_b);

/// \return empty if the blob is not 56 bytes long or no pose.
std::optional<Eigen::Isometry3d> pose_from_blob(std::span<const std::uint8_t> blob);

}  // namespace kinship::store
