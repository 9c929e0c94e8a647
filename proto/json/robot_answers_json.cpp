#include "proto/json/robot_answers_json.hpp"

#include "proto/json/fields.hpp"

namespace kinship::json {

std::string to_json(const InverseAnswer& answer) {
  OrderedJson document;
  document["solver"] = answer.solver;
  document["solutions"] = list_of_columns(answer.solutions);
  document["reason"] = answer.reason.empty() ? OrderedJson(nullptr) : OrderedJson(answer.reason);
  document["time_us"] = answer.time_us;
  if (answer.colliding)
    document["colliding"] = *answer.colliding;
  return write(kInverseKinematicsFormat, document);
}

std::string to_json(const ForwardAnswer& answer) {
  OrderedJson document;
  document["q"] = list(answer.q);
  document["frame"] = answer.is_in_task ? "task" : "base";
  document["tip"] = pose_list(answer.tip);
  document["transfer"] = pose_list(answer.transfer);
  return write(kForwardKinematicsFormat, document);
}

std::string to_json(const std::string& task, const std::vector<Transferability>& pairs) {
  OrderedJson rows = OrderedJson::array();
  for (const Transferability& pair : pairs) {
    OrderedJson row;
    row["target"] = pair.target.hex();
    row["target_label"] = pair.target_label;
    row["source"] = pair.source.hex();
    row["source_label"] = pair.source_label;
    const auto value = pair.rehearsal ? worth(*pair.rehearsal) : std::nullopt;
    row["worth"] = value ? OrderedJson(value->value()) : OrderedJson(nullptr);
    row["worth_by_time"] = value && value->by_time ? OrderedJson(*value->by_time) : nullptr;
    row["worth_by_checks"] = value ? OrderedJson(value->by_checks) : nullptr;
    row["without_experience"] = value ? OrderedJson(to_text(value->without)) : nullptr;
    row["with_experience"] = value ? OrderedJson(to_text(value->with)) : nullptr;
    row["rehearsal"] = pair.rehearsal ? json_of(*pair.rehearsal) : OrderedJson(nullptr);
    row["message"] = pair.message;
    rows.push_back(std::move(row));
  }
  OrderedJson document;
  document["task"] = task;
  document["rows"] = std::move(rows);
  return write(kRobotComparisonFormat, document);
}

std::string to_json(const RobotCheck& check) {
  OrderedJson document;
  document["robot"] = check.robot.hex();
  document["base_link"] = check.base_link;
  document["tip_link"] = check.tip_link;
  document["dof"] = check.joints.size();
  document["joints"] = json_of(check.joints);
  document["structure"] = check.structure;
  document["solver"] = check.solver;
  document["poses"] = check.poses;
  document["poses_without_solution"] = check.poses_without_solution;
  document["solutions_per_pose"] = check.solutions_per_pose;
  document["time_per_pose_us"] = check.time_per_pose_us;
  document["reach_m"] = check.reach_m;
  document["transfer_distance_m"] = check.transfer_distance_m;
  document["links"] = json_of(check.links);
  return write(kRobotCheckFormat, document);
}

std::string to_json(const RobotLinks& links) { return write_fields(links, kRobotLinksFormat); }
std::string to_json(const RobotFrames& frames) { return write_fields(frames, kRobotFramesFormat); }
std::string to_json(const SrdfSuggestion& suggestion) {
  return write_fields(suggestion, kSrdfSuggestionFormat);
}

std::string to_json(const RegisterReply& reply, const std::string& label) {
  OrderedJson document;
  document["robot"] = reply.robot.hex();
  document["label"] = label;
  document["known"] = reply.status == RegisterStatus::Known;
  document["dof"] = reply.dof;
  document["solver"] = reply.solver;
  document["same_arms"] = reply.same_arms;
  document["geometry"] = reply.geometry;
  document["geometry_grade"] = to_text(reply.geometry_grade);
  document["took_geometry"] = reply.took_geometry;
  document["meshes"] = reply.meshes;
  document["meshes_missing"] = reply.wanted.size();
  return write(kRobotRegistrationFormat, document);
}

Result<Eigen::Isometry3d> pose_from_json(std::string_view text) {
  try {
    return Document(text, "pose").any_root().pose();
  } catch (const Failure& failure) {
    return failure.error();
  }
}

Result<Eigen::VectorXd> configuration_from_json(std::string_view text) {
  try {
    return Document(text, "configuration").any_root().vector(kMaxDof);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::json
