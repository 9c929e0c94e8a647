#include "server/store/values/path_content.hpp"

#include <utility>

#include "server/store/values/crc32c.hpp"
#include "server/store/values/waypoint_blob.hpp"

namespace kinship::store {

std::uint32_t PathContent::crc() const {
  ByteWriter header;
  header.add(report_uuid).add(T_task_base);
  for (const std::int64_t number : {dof, waypoint_count, encoding})
    header.add(static_cast<std::uint64_t>(number));
  return crc32c(waypoints, crc32c(header.bytes()));
}

std::optional<StoredPath> PathContent::decode() const {
  std::optional<Path> path = decode_waypoints(dof, waypoint_count, encoding, waypoints);
  if (!path)
    return std::nullopt;
  std::optional<Eigen::Isometry3d> placement;
  if (!T_task_base.empty()) {
    placement = pose_from_blob(T_task_base);
    if (!placement)
      return std::nullopt;
  }
  return StoredPath{0, id_of<Uuid>(report_uuid), placement, 0, std::move(*path)};
}

}  // namespace kinship::store
