#include "proto/codec/reader.hpp"

#include <cstring>

#include "proto/types/pose.hpp"

namespace kinship::codec {

Digest read_digest(const std::uint8_t (&bytes)[32]) {
  Digest digest;
  std::copy(std::begin(bytes), std::end(bytes), digest.bytes.begin());
  return digest;
}

Uuid read_uuid(const std::uint8_t (&bytes)[16]) {
  Uuid uuid;
  std::copy(std::begin(bytes), std::end(bytes), uuid.bytes.begin());
  return uuid;
}

std::optional<Eigen::Isometry3d> Reader::placement(std::string_view what,
                                                   std::span<const double> numbers) {
  if (numbers.empty())
    return std::nullopt;
  if (numbers.size() != 7) {
    rules.that(false, std::string(what) + ": " + std::to_string(numbers.size()) +
                          " numbers, must be none or 7");
    return std::nullopt;
  }
  return pose(what, numbers.first<7>());
}

Eigen::Isometry3d Reader::pose(std::string_view what, std::span<const double, 7> numbers) {
  PoseArray array{};
  std::copy(numbers.begin(), numbers.end(), array.begin());
  const auto T = from_pose_array(array);
  if (T)
    return *T;
  rules.that(false, std::string(what) + ": " + T.error().message);
  return Eigen::Isometry3d::Identity();
}

std::optional<Digest> Reader::optional_digest(std::string_view what,
                                              std::span<const std::uint8_t> bytes) {
  if (bytes.empty())
    return std::nullopt;
  Digest digest;
  if (bytes.size() == digest.bytes.size())
    std::copy(bytes.begin(), bytes.end(), digest.bytes.begin());
  else
    rules.that(false, std::string(what) + ": " + std::to_string(bytes.size()) +
                          " bytes, must be none or 32");
  return digest;
}

std::optional<double> Reader::optional_number(std::string_view what,
                                              std::span<const double> value) {
  if (value.empty())
    return std::nullopt;
  rules.at_most(what, value.size(), 1).finite(what, value[0]);
  return value[0];
}

}  // namespace kinship::codec
