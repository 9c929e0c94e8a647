#include "server/sites/carry_robot.hpp"

#include <string>

#include "proto/types/limits.hpp"

namespace kinship::sites {
namespace {

/// As long as a label may be.
std::string with_digest(const std::string& label, const Digest& robot) {
  const std::string digest = "-" + robot.short_hex();
  return label.substr(0, kMaxLabelBytes - digest.size()) + digest;
}

}  // namespace

std::optional<Error> carry_robot(const store::RobotStore& from, store::RobotStore& to,
                                 const Digest& robot) {
  if (to.find_robot(robot))
    return std::nullopt;
  std::optional<store::RobotRecord> record = from.find_robot(robot);
  if (!record)
    return Error{ErrorCode::Unavailable,
                 "robot " + robot.short_hex() + " is not registered where the report comes from"};
  // Each store counts for itself how often it took better geometry over.
  record->geometry_revision = 0;
  record->geometry_ms = 0;
  Result<RegisterStatus> status = to.register_robot(*record);
  if (!status && status.error().code == ErrorCode::Conflict) {
    record->description.label = with_digest(record->description.label, robot);
    status = to.register_robot(*record);
  }
  if (!status)
    return status.error();
  return std::nullopt;
}

}  // namespace kinship::sites
