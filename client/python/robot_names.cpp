#include "client/python/robot_names.hpp"

#include <optional>

#include "proto/types/failure.hpp"

namespace kinship::python {

void set_robot(json::NamedAttempt& attempt, const RobotName& robot) {
  attempt.label.clear();
  attempt.attempt.robot = {};
  if (const auto* known = std::get_if<std::shared_ptr<Robot>>(&robot))
    attempt.attempt.robot = (*known)->digest();
  else if (const auto digest = Digest::from_hex(std::get<std::string>(robot)))
    attempt.attempt.robot = *digest;
  else
    attempt.label = std::get<std::string>(robot);
}

const Attempt& attempt_of(const json::NamedAttempt& named) {
  if (!named.label.empty())
    throw Failure(ErrorCode::InvalidInput, "attempt " + named.attempt.report_uuid.text() +
                                               " names its robot by the label '" + named.label +
                                               "': set its robot to a Robot, or its digest");
  return named.attempt;
}

}  // namespace kinship::python
