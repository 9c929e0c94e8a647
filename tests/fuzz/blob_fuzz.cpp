// Bytes from a store file as any of its blobs, past their checksums: decoded to a value that
// encodes and decodes to itself, or to nothing.

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>

#include "server/store/values/distribution_blob.hpp"
#include "server/store/values/rehearsal_blob.hpp"
#include "server/store/values/scene_blob.hpp"
#include "server/store/values/search_blob.hpp"
#include "server/store/values/waypoint_blob.hpp"
#include "tests/fuzz/demand.hpp"

namespace kinship::fuzz {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// The first two bytes as a number, taken away.
std::int64_t take_number(Bytes& bytes) {
  std::int64_t number = 0;
  for (int i = 0; i < 2 && !bytes.empty(); ++i) {
    number = 256 * number + bytes[0];
    bytes = bytes.subspan(1);
  }
  return number;
}

void try_waypoints(Bytes bytes) {
  const std::int64_t dof = take_number(bytes), count = take_number(bytes);
  const std::int64_t encoding = take_number(bytes);
  const auto path = store::decode_waypoints(dof, count, encoding, bytes);
  if (!path)
    return;
  const store::WaypointBlob blob = store::encode_waypoints(path->waypoints());
  const auto again = store::decode_waypoints(blob.dof, blob.waypoint_count,
                                             static_cast<std::int64_t>(blob.encoding), blob.bytes);
  demand(again &&
             std::equal(again->waypoints().reshaped().begin(), again->waypoints().reshaped().end(),
                        path->waypoints().reshaped().begin()),
         "waypoints come back the same");
}

void try_scene(Bytes bytes) {
  const std::int64_t size = 16 * take_number(bytes) + take_number(bytes) % 16;
  const std::int64_t encoding = take_number(bytes);
  const auto scene = store::decode_scene(size, encoding, bytes);
  if (!scene)
    return;
  const store::SceneBlob blob = store::encode_scene(*scene);
  demand(store::decode_scene(blob.size, static_cast<std::int64_t>(blob.encoding), blob.bytes)
             .has_value(),
         "a scene comes back");
}

void try_distribution(Bytes bytes) {
  const auto distribution = store::decode_distribution(bytes);
  if (distribution)
    demand(store::decode_distribution(store::encode_distribution(*distribution)).has_value(),
           "a distribution comes back");
}

void try_rehearsal(Bytes bytes) {
  store::StoredRehearsal rehearsal;
  if (store::decode_rehearsal(bytes, rehearsal))
    demand(store::decode_rehearsal(store::encode_rehearsal(rehearsal), rehearsal),
           "a rehearsal comes back");
}

void try_search(Bytes bytes) {
  std::optional<SearchRecord> search = store::decode_search(bytes);
  if (!search)
    return;
  std::optional<SearchRecord> again = store::decode_search(store::encode_search(*search));
  demand(again.has_value(), "a search record comes back");
  for (SearchRecord* const each : {&*search, &*again}) {  // poses, but for their last bits
    each->T_task_start.reset();
    each->T_task_goal.reset();
  }
  demand(store::encode_search(*again) == store::encode_search(*search),
         "a search record comes back the same");
}

}  // namespace
}  // namespace kinship::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const kinship::fuzz::Bytes bytes(data + 1, size - 1);
  switch (data[0] % 5) {
    case 0:
      kinship::fuzz::try_waypoints(bytes);
      break;
    case 1:
      kinship::fuzz::try_scene(bytes);
      break;
    case 2:
      kinship::fuzz::try_distribution(bytes);
      break;
    case 3:
      kinship::fuzz::try_rehearsal(bytes);
      break;
    default:
      kinship::fuzz::try_search(bytes);
  }
  return 0;
}
