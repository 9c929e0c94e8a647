#pragma once

#include <cstddef>
#include <optional>

#include "proto/codec/message.hpp"
#include "proto/idl/report.h"

namespace kinship::codec {

/// The rule of the contract that an attempt breaks, if any. Whether the robot is known and the
/// path within its limits is for the server to say.
std::optional<Error> check(const Attempt& attempt);

/// What attempts count against the bounds of a batch.
struct BatchBytes {
  std::size_t waypoints = 0;  ///< 8 a waypoint and joint; at most kMaxBatchBytes
  std::size_t scenes = 0;     ///< as scene_bytes() counts; at most kMaxSceneBytes

  bool fits() const noexcept { return waypoints <= kMaxBatchBytes && scenes <= kMaxSceneBytes; }

  friend BatchBytes operator+(const BatchBytes& a, const BatchBytes& b) noexcept {
    return {a.waypoints + b.waypoints, a.scenes + b.scenes};
  }
};

BatchBytes batch_bytes(const Attempt& attempt);

/// \return InvalidInput or TooLarge if an attempt breaks a rule or the batch is too large.
Result<Message<kinship_wire_ReportRequest>> encode(const Head& head, const ReportRequest& request);

/// Attempts that break a rule come out as refused receipts; the others are not affected. An error
/// only if there are more attempts than a batch may have.
Result<ReportRequest> decode(const kinship_wire_ReportRequest& wire);

Result<Message<kinship_wire_ReportReply>> encode(const Head& head, const ReportReply& reply);
Result<ReportReply> decode(const kinship_wire_ReportReply& wire);

}  // namespace kinship::codec
