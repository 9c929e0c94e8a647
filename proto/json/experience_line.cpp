#include "proto/json/experience_line.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/parts.hpp"

namespace kinship::json {
namespace {

ExperienceLine read_line(const Reader& reader) {
  if (const auto description = reader.find("robot_description")) {
    check_format(reader, kExperienceRobotFormat);
    return read_robot_description(*description);
  }
  check_format(reader, kAttemptFormat);
  if (!reader.find("report_uuid"))
    throw Failure(ErrorCode::InvalidInput,
                  "line of an experience file: needs a member robot_description or report_uuid");
  return read_attempt(reader);
}

}  // namespace

std::string to_experience_line(const RobotDescription& description) {
  OrderedJson object;
  object["robot_description"] = robot_description_object(description);
  return write(kExperienceRobotFormat, object);
}

Result<ExperienceLine> experience_line_from_json(std::string_view text) {
  return read_document(text, "line of an experience file", read_line);
}

}  // namespace kinship::json
