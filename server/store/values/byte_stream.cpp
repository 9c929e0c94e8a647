#include "server/store/values/byte_stream.hpp"

#include <cstring>
#include <stdexcept>

#include "proto/types/pose.hpp"

namespace kinship::store {
namespace {

std::span<const std::uint8_t> as_bytes(const double* values, std::size_t count) {
  return {reinterpret_cast<const std::uint8_t*>(values), count * sizeof(double)};
}

}  // namespace

ByteWriter& ByteWriter::add(std::uint64_t value) {
  return add(
      std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(&value), sizeof value));
}

ByteWriter& ByteWriter::add(double value) { return add(as_bytes(&value, 1)); }

ByteWriter& ByteWriter::add(std::string_view text) {
  add(std::uint64_t{text.size()});
  bytes_.insert(bytes_.end(), text.begin(), text.end());
  return *this;
}

ByteWriter& ByteWriter::add(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return *this;
}

ByteWriter& ByteWriter::add(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  add(static_cast<std::uint64_t>(values.rows()));
  add(static_cast<std::uint64_t>(values.cols()));
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    add(as_bytes(values.col(column).data(), static_cast<std::size_t>(values.rows())));
  return *this;
}

ByteWriter& ByteWriter::add(const std::optional<Eigen::Isometry3d>& T_a_b) {
  add(std::uint64_t{T_a_b ? 1U : 0U});
  return T_a_b ? add(std::span<const std::uint8_t>(pose_blob(*T_a_b))) : *this;
}

std::span<const std::uint8_t> ByteReader::take(std::size_t size) {
  if (size > rest_.size())
    throw std::out_of_range("blob: " + std::to_string(size) + " bytes wanted, " +
                            std::to_string(rest_.size()) + " left");
  const std::span<const std::uint8_t> taken = rest_.first(size);
  rest_ = rest_.subspan(size);
  return taken;
}

std::uint64_t ByteReader::integer() {
  std::uint64_t value = 0;
  std::memcpy(&value, take(sizeof value).data(), sizeof value);
  return value;
}

std::size_t ByteReader::integer(std::size_t max) {
  const std::uint64_t value = integer();
  if (value > max)
    throw std::out_of_range("blob: " + std::to_string(value) + " of at most " +
                            std::to_string(max));
  return value;
}

double ByteReader::real() {
  double value = 0;
  std::memcpy(&value, take(sizeof value).data(), sizeof value);
  return value;
}

std::string ByteReader::text(std::size_t max_size) {
  const std::uint64_t size = integer();
  if (size > max_size)
    throw std::out_of_range("blob: text of " + std::to_string(size) + " bytes");
  const std::span<const std::uint8_t> taken = take(size);
  return {taken.begin(), taken.end()};
}

void ByteReader::bytes(std::span<std::uint8_t> out) {
  const std::span<const std::uint8_t> taken = take(out.size());
  if (!out.empty())
    std::memcpy(out.data(), taken.data(), taken.size());
}

Eigen::MatrixXd ByteReader::matrix(std::size_t max_rows, std::size_t max_cols) {
  const std::uint64_t rows = integer();
  const std::uint64_t cols = integer();
  if (rows > max_rows || cols > max_cols)
    throw std::out_of_range("blob: matrix of " + std::to_string(rows) + " x " +
                            std::to_string(cols));
  const std::span<const std::uint8_t> taken = take(rows * cols * sizeof(double));
  Eigen::MatrixXd values(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
  if (!taken.empty())
    std::memcpy(values.data(), taken.data(), taken.size());
  return values;
}

std::optional<Eigen::Isometry3d> ByteReader::pose() {
  if (integer() == 0)
    return std::nullopt;
  return bare_pose();
}

Eigen::Isometry3d ByteReader::bare_pose() {
  const std::optional<Eigen::Isometry3d> T_a_b = pose_from_blob(take(sizeof(PoseArray)));
  if (!T_a_b)
    throw std::out_of_range("blob: seven numbers that are no pose");
  return *T_a_b;
}

std::vector<std::uint8_t> pose_blob(const Eigen::Isometry3d& T_a_b) {
  const PoseArray pose = to_pose_array(T_a_b);
  const std::span<const std::uint8_t> bytes = as_bytes(pose.data(), pose.size());
  return {bytes.begin(), bytes.end()};
}

std::optional<Eigen::Isometry3d> pose_from_blob(std::span<const std::uint8_t> blob) {
  PoseArray pose{};
  if (blob.size() != sizeof pose)
    return std::nullopt;
  std::memcpy(pose.data(), blob.data(), sizeof pose);
  const Result<Eigen::Isometry3d> T_a_b = from_pose_array(pose);
  if (!T_a_b)
    return std::nullopt;
  return *T_a_b;
}

}  // namespace kinship::store
