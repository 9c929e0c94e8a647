#include "server/store/rules/batch_changes.hpp"

namespace kinship::store {

PathContent content_of(const NewPath& path, Bytes T_task_base) {
  const WaypointBlob& blob = path.from->path->blob;
  PathContent content{
      Bytes(path.from->attempt.report_uuid.bytes), T_task_base,      blob.dof, blob.waypoint_count,
      static_cast<std::int64_t>(blob.encoding),    Bytes(blob.bytes)};
  if (path.is_dropped) {
    content.encoding = kEncodingOfDropped;
    content.waypoints = Bytes(kNoWaypoints);
  }
  return content;
}

}  // namespace kinship::store
