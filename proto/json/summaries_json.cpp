#include "proto/json/summaries_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/reader.hpp"
#include "proto/json/record_json.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

std::uint32_t read_count32(const Reader& reader) {
  return static_cast<std::uint32_t>(reader.count(std::numeric_limits<std::uint32_t>::max()));
}

RobotSummary read_robot_summary(const Reader& reader) {
  RobotSummary summary;
  summary.robot = reader.at("robot").digest();
  summary.label = reader.at("label").text(kMaxLabelBytes);
  summary.base_link = reader.at("base_link").text(kMaxLinkNameBytes);
  summary.tip_link = reader.at("tip_link").text(kMaxLinkNameBytes);
  summary.dof = read_count32(reader.at("dof"));
  summary.solver = reader.at("solver").text(kMaxMessageBytes);
  summary.paths = reader.at("paths").count();
  summary.attempts = reader.at("attempts").count();
  summary.registered_ms = reader.at("registered_ms").integer();
  return summary;
}

TaskSummary read_task_summary(const Reader& reader) {
  TaskSummary summary;
  summary.task = reader.at("task").text(kMaxTaskBytes);
  summary.paths = reader.at("paths").count();
  summary.attempts = reader.at("attempts").count();
  for (const Reader& element : reader.at("robots").elements(kMaxSources)) {
    TaskRobotSummary robot;
    robot.robot = element.at("robot").digest();
    robot.label = element.at("label").text(kMaxLabelBytes);
    robot.paths = element.at("paths").count();
    robot.attempts = element.at("attempts").count();
    robot.generation = element.at("generation").count();
    summary.robots.push_back(robot);
  }
  return summary;
}

PathSummary read_path_summary(const Reader& reader) {
  PathSummary summary;
  summary.report_uuid = reader.at("report_uuid").uuid();
  summary.robot = reader.at("robot").digest();
  summary.label = reader.at("label").text(kMaxLabelBytes);
  summary.task = reader.at("task").text(kMaxTaskBytes);
  summary.machine = reader.at("machine").text(kMaxMachineBytes);
  if (const auto placement = reader.find("T_task_base"))
    summary.T_task_base = placement->pose();
  summary.record = read_record(reader.at("record"));
  summary.waypoints = reader.at("waypoints").count();
  summary.length = reader.at("length").number(0);
  summary.received_ms = reader.at("received_ms").integer();
  summary.retired_ms = reader.at("retired_ms").integer();
  return summary;
}

DistributionSummary read_distribution_summary(const Reader& reader) {
  DistributionSummary summary;
  summary.id = reader.at("id").digest();
  summary.revision = reader.at("revision").count();
  summary.task = reader.at("task").text(kMaxTaskBytes);
  summary.robot = reader.at("robot").digest();
  summary.label = reader.at("label").text(kMaxLabelBytes);
  summary.profile = reader.at("profile").text(kMaxProfileBytes);
  summary.state = parse_distribution_state(reader.at("state").text(kMaxWordBytes)).value_or_throw();
  summary.reason = reader.at("reason").text(kMaxMessageBytes);
  summary.components = reader.at("components").count();
  summary.configurations = reader.at("configurations").count();
  summary.paths = reader.at("paths").count();
  summary.fitted_ms = reader.at("fitted_ms").integer();
  return summary;
}

ServerStatus read_status(const Reader& reader) {
  ServerStatus status;
  status.version = reader.at("version").text(kMaxMessageBytes);
  status.store_file = reader.at("store_file").text(kMaxPageBytes);
  status.store_epoch = reader.at("store_epoch").uuid();
  status.schema_version = read_count32(reader.at("schema_version"));
  status.uptime_s = reader.at("uptime_s").count();
  status.robots = reader.at("robots").count();
  status.tasks = reader.at("tasks").count();
  status.paths = reader.at("paths").count();
  status.attempts = reader.at("attempts").count();
  status.distributions = reader.at("distributions").count();
  status.reports_received = reader.at("reports_received").count();
  status.reports_refused = reader.at("reports_refused").count();
  status.fetches = reader.at("fetches").count();
  status.fetches_from_memory = reader.at("fetches_from_memory").count();
  status.fits = reader.at("fits").count();
  status.queued_reports = reader.at("queued_reports").count();
  status.queued_fits = reader.at("queued_fits").count();
  status.followed = reader.at("followed").count();
  status.jobs = reader.at("jobs").count();
  status.store_bytes = reader.at("store_bytes").count();
  status.writable = reader.at("writable").boolean();
  status.storage_message = reader.at("storage_message").text(kMaxPageBytes);
  return status;
}

}  // namespace

std::string to_json(const RobotSummary& summary) {
  OrderedJson object;
  object["robot"] = summary.robot.hex();
  object["label"] = summary.label;
  object["base_link"] = summary.base_link;
  object["tip_link"] = summary.tip_link;
  object["dof"] = summary.dof;
  object["solver"] = summary.solver;
  object["paths"] = summary.paths;
  object["attempts"] = summary.attempts;
  object["registered_ms"] = summary.registered_ms;
  return write(object);
}

std::string to_json(const TaskSummary& summary) {
  OrderedJson object;
  object["task"] = summary.task;
  object["paths"] = summary.paths;
  object["attempts"] = summary.attempts;
  object["robots"] = OrderedJson::array();
  for (const TaskRobotSummary& robot : summary.robots)
    object["robots"].push_back({{"robot", robot.robot.hex()},
                                {"label", robot.label},
                                {"paths", robot.paths},
                                {"attempts", robot.attempts},
                                {"generation", robot.generation}});
  return write(object);
}

std::string to_json(const PathSummary& summary) {
  OrderedJson object;
  object["report_uuid"] = summary.report_uuid.text();
  object["robot"] = summary.robot.hex();
  object["label"] = summary.label;
  object["task"] = summary.task;
  object["machine"] = summary.machine;
  object["T_task_base"] = pose_or_null(summary.T_task_base);
  object["record"] = record_object(summary.record);
  object["waypoints"] = summary.waypoints;
  object["length"] = summary.length;
  object["received_ms"] = summary.received_ms;
  object["retired_ms"] = summary.retired_ms;
  return write(object);
}

std::string to_json(const DistributionSummary& summary) {
  OrderedJson object;
  object["id"] = summary.id.hex();
  object["revision"] = summary.revision;
  object["task"] = summary.task;
  object["robot"] = summary.robot.hex();
  object["label"] = summary.label;
  object["profile"] = summary.profile;
  object["state"] = to_text(summary.state);
  object["reason"] = summary.reason;
  object["components"] = summary.components;
  object["configurations"] = summary.configurations;
  object["paths"] = summary.paths;
  object["fitted_ms"] = summary.fitted_ms;
  return write(object);
}

std::string to_json(const ServerStatus& status) {
  OrderedJson object;
  object["version"] = status.version;
  object["store_file"] = status.store_file;
  object["store_epoch"] = status.store_epoch.text();
  object["schema_version"] = status.schema_version;
  object["uptime_s"] = status.uptime_s;
  object["robots"] = status.robots;
  object["tasks"] = status.tasks;
  object["paths"] = status.paths;
  object["attempts"] = status.attempts;
  object["distributions"] = status.distributions;
  object["reports_received"] = status.reports_received;
  object["reports_refused"] = status.reports_refused;
  object["fetches"] = status.fetches;
  object["fetches_from_memory"] = status.fetches_from_memory;
  object["fits"] = status.fits;
  object["queued_reports"] = status.queued_reports;
  object["queued_fits"] = status.queued_fits;
  object["followed"] = status.followed;
  object["jobs"] = status.jobs;
  object["store_bytes"] = status.store_bytes;
  object["writable"] = status.writable;
  object["storage_message"] = status.storage_message;
  return write(object);
}

Result<RobotSummary> robot_summary_from_json(std::string_view text) {
  return read_document(text, "robot", read_robot_summary);
}

Result<TaskSummary> task_summary_from_json(std::string_view text) {
  return read_document(text, "task", read_task_summary);
}

Result<PathSummary> path_summary_from_json(std::string_view text) {
  return read_document(text, "path", read_path_summary);
}

Result<DistributionSummary> distribution_summary_from_json(std::string_view text) {
  return read_document(text, "distribution", read_distribution_summary);
}

Result<ServerStatus> server_status_from_json(std::string_view text) {
  return read_document(text, "status", read_status);
}

}  // namespace kinship::json
