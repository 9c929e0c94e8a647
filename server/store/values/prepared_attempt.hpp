#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/result.hpp"
#include "server/store/store.hpp"
#include "server/store/values/scene_blob.hpp"
#include "server/store/values/waypoint_blob.hpp"

namespace kinship::store {

/// A path ready to be written.
struct PreparedPath {
  Digest waypoints;   ///< of the waypoints alone
  Digest content;     ///< of waypoints and snapped placement: kept once per robot and task
  double length = 0;  ///< joint units
  WaypointBlob blob;
};

/// A scene ready to be written.
struct PreparedScene {
  Digest content;  ///< kept once
  SceneBlob blob;
};

/// A search record ready to be written.
struct PreparedSearch {
  std::string why;                    ///< why_text()
  std::vector<std::uint8_t> payload;  ///< encode_search()

  std::uint64_t bytes() const { return 128 + why.size() + payload.size(); }  ///< of its row, about
};

/// An attempt with all values that can be computed before the writer gets it.
struct PreparedAttempt {
  Attempt attempt;  ///< without its path, scene and search record
  /// Of everything but the UUID and the search record: tells a retry from a second use of the UUID.
  Digest body;
  std::optional<PreparedPath> path;
  std::optional<PreparedScene> scene;
  std::optional<PreparedSearch> search;
  std::optional<std::int64_t> received_ms;  ///< by the first store that had it; missing: now
  bool is_retired = false;                  ///< its path, elsewhere
};

/// The UUIDs of the reports.
std::vector<Uuid> report_uuids(const std::vector<Attempt>& attempts);
std::vector<Uuid> report_uuids(const std::vector<ReplicatedReport>& reports);

/// The body of the same report from another machine.
Digest body_said_by(const PreparedAttempt& prepared, const std::string& machine);

/// \param attempt  valid (validate(Attempt)): the server checked it when it arrived.
/// \return the reason if it cannot be stored: a counter over 2^63.
Result<PreparedAttempt> prepare(Attempt attempt);
/// The same for a report from another store, with the body that its robot sent. Its attempt is
/// checked here.
Result<PreparedAttempt> prepare(ReplicatedReport report);

}  // namespace kinship::store
