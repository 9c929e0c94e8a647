#include "proto/json/attempt_json.hpp"

#include "proto/json/fields.hpp"
#include "proto/json/parts.hpp"
#include "proto/json/recorded_scene_json.hpp"
#include "proto/json/search_record_json.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
namespace {

void read_robot(const Reader& reader, NamedAttempt& named) {
  const std::string text = reader.text(kMaxLabelBytes);
  if (const auto digest = Digest::from_hex(text)) {
    named.attempt.robot = *digest;
    return;
  }
  if (const auto error = check_label(text))
    reader.refuse(error->message);
  named.label = text;
}

/// Whether a solved attempt may be without its waypoints.
enum class Waypoints { Required, MayBeDropped };

std::optional<Path> read_path(const Reader& reader, Outcome outcome, Waypoints rule) {
  const auto waypoints = reader.find("waypoints");
  if (outcome != Outcome::Solved) {
    if (waypoints)
      waypoints->refuse("must be null unless record.outcome is 'solved'");
    return std::nullopt;
  }
  if (!waypoints && rule == Waypoints::MayBeDropped)
    return std::nullopt;
  if (!waypoints)
    reader.at("waypoints").refuse("must not be null if record.outcome is 'solved'");
  Eigen::MatrixXd matrix = waypoints->columns(kMaxDof, kMaxWaypoints);
  if (matrix.cols() < 2 || matrix.rows() < 1)
    waypoints->refuse(std::to_string(matrix.cols()) + " waypoints of " +
                      std::to_string(matrix.rows()) + " joints, must be at least 2 of 1");
  return Path(std::move(matrix));
}

NamedAttempt read(const Reader& reader, Waypoints rule) {
  NamedAttempt named;
  Attempt& attempt = named.attempt;
  attempt.report_uuid = reader.at("report_uuid").uuid();
  attempt.task = reader.at("task").text(kMaxTaskBytes);
  read_robot(reader.at("robot"), named);
  if (const auto machine = reader.find("machine"))
    attempt.machine = machine->text(kMaxMachineBytes);
  if (const auto placement = reader.find("T_task_base"))
    attempt.T_task_base = placement->pose();
  attempt.record = read_as<PlanningRecord>(reader.at("record"));
  attempt.path = read_path(reader, attempt.record.outcome, rule);
  if (const auto scene = reader.find("scene"))
    attempt.scene = read_recorded_scene(*scene);
  if (const auto search = reader.find("search"))
    attempt.search = read_search_record(*search);
  const bool is_dropped = !attempt.path && attempt.record.outcome == Outcome::Solved;
  if (const auto error = is_dropped ? std::nullopt : validate(attempt))
    throw Failure(*error);
  return named;
}

}  // namespace

NamedAttempt read_attempt(const Reader& reader) { return read(reader, Waypoints::Required); }

std::string to_json(const Attempt& attempt) {
  OrderedJson object;
  object["report_uuid"] = attempt.report_uuid.text();
  object["task"] = attempt.task;
  object["robot"] = attempt.robot.hex();
  object["machine"] = attempt.machine;
  object["T_task_base"] = pose_or_null(attempt.T_task_base);
  object["waypoints"] =
      attempt.path ? list_of_columns(attempt.path->waypoints()) : OrderedJson(nullptr);
  object["record"] = json_of(attempt.record);
  object["scene"] = attempt.scene ? recorded_scene_object(*attempt.scene) : OrderedJson(nullptr);
  if (attempt.search)
    object["search"] = search_record_object(*attempt.search);
  return write(kAttemptFormat, object);
}

Result<NamedAttempt> attempt_from_json(std::string_view text) {
  return read_document(text, "experience", kAttemptFormat, read_attempt);
}

Result<NamedAttempt> stored_attempt_from_json(std::string_view text) {
  return read_document(text, "experience", kAttemptFormat,
                       [](const Reader& reader) { return read(reader, Waypoints::MayBeDropped); });
}

}  // namespace kinship::json
