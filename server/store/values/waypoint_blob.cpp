#include "server/store/values/waypoint_blob.hpp"

#include <bit>
#include <cstring>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/values/compression.hpp"

namespace kinship::store {
namespace {

static_assert(std::endian::native == std::endian::little, "blobs hold little-endian numbers");

constexpr std::size_t kPlanes = sizeof(double);

/// Small differences of either sign become small numbers.
std::uint64_t zigzag(std::uint64_t difference) {
  return (difference << 1U) ^ (0U - (difference >> 63U));
}

std::uint64_t unzigzag(std::uint64_t value) { return (value >> 1U) ^ (0U - (value & 1U)); }

/// Byte plane p holds byte p of every difference; the differences go joint by joint, because one
/// joint's values resemble each other most.
std::vector<std::uint8_t> shuffled_differences(const Eigen::MatrixXd& waypoints) {
  const auto count = static_cast<std::size_t>(waypoints.size());
  std::vector<std::uint8_t> planes(kPlanes * count);
  std::size_t position = 0;
  for (Eigen::Index joint = 0; joint < waypoints.rows(); ++joint) {
    std::uint64_t before = 0;
    for (Eigen::Index waypoint = 0; waypoint < waypoints.cols(); ++waypoint, ++position) {
      const auto bits = std::bit_cast<std::uint64_t>(waypoints(joint, waypoint));
      const std::uint64_t value = zigzag(bits - before);
      before = bits;
      for (std::size_t plane = 0; plane < kPlanes; ++plane)
        planes[plane * count + position] = static_cast<std::uint8_t>(value >> (8 * plane));
    }
  }
  return planes;
}

Eigen::MatrixXd from_shuffled_differences(const std::vector<std::uint8_t>& planes, Eigen::Index dof,
                                          Eigen::Index waypoint_count) {
  Eigen::MatrixXd waypoints(dof, waypoint_count);
  const std::size_t count = planes.size() / kPlanes;
  std::size_t position = 0;
  for (Eigen::Index joint = 0; joint < dof; ++joint) {
    std::uint64_t bits = 0;
    for (Eigen::Index waypoint = 0; waypoint < waypoint_count; ++waypoint, ++position) {
      std::uint64_t value = 0;
      for (std::size_t plane = 0; plane < kPlanes; ++plane)
        value |= std::uint64_t{planes[plane * count + position]} << (8 * plane);
      bits += unzigzag(value);
      waypoints(joint, waypoint) = std::bit_cast<double>(bits);
    }
  }
  return waypoints;
}

}  // namespace

WaypointBlob encode_waypoints(const Eigen::MatrixXd& waypoints) {
  WaypointBlob blob;
  blob.dof = waypoints.rows();
  blob.waypoint_count = waypoints.cols();
  const auto raw_size = static_cast<std::size_t>(waypoints.size()) * sizeof(double);

  if (std::optional<std::vector<std::uint8_t>> compressed =
          compress(shuffled_differences(waypoints))) {
    blob.encoding = WaypointEncoding::Delta;
    blob.bytes = std::move(*compressed);
    return blob;
  }
  blob.encoding = WaypointEncoding::Raw;
  blob.bytes.resize(raw_size);
  std::memcpy(blob.bytes.data(), waypoints.data(), raw_size);
  return blob;
}

std::optional<Path> decode_waypoints(std::int64_t dof, std::int64_t waypoint_count,
                                     std::int64_t encoding, std::span<const std::uint8_t> bytes) {
  if (dof < 1 || dof > static_cast<std::int64_t>(kMaxDof) || waypoint_count < 2 ||
      waypoint_count > static_cast<std::int64_t>(kMaxWaypoints))
    return std::nullopt;
  const auto raw_size = static_cast<std::size_t>(dof * waypoint_count) * sizeof(double);
  Eigen::MatrixXd waypoints;
  if (encoding == static_cast<std::int64_t>(WaypointEncoding::Raw)) {
    if (bytes.size() != raw_size)
      return std::nullopt;
    waypoints.resize(dof, waypoint_count);
    std::memcpy(waypoints.data(), bytes.data(), raw_size);
  } else if (encoding == static_cast<std::int64_t>(WaypointEncoding::Delta)) {
    const std::optional<std::vector<std::uint8_t>> planes = decompress(bytes, raw_size);
    if (!planes)
      return std::nullopt;
    waypoints = from_shuffled_differences(*planes, dof, waypoint_count);
  } else {
    return std::nullopt;
  }
  if (!waypoints.allFinite())
    return std::nullopt;
  return Path(std::move(waypoints));
}

}  // namespace kinship::store
