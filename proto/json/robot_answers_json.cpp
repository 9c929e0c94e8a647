#include "proto/json/robot_answers_json.hpp"

#include "proto/json/fields.hpp"

namespace kinship::json {

std::string to_json(const InverseAnswer& answer) {
  OrderedJson document;
  document["solver"] = answer.solver;
  document["solutions"] = list_of_columns(answer.solutions);
  document["reason"] = answer.reason.empty() ? OrderedJson(nullptr) : OrderedJson(answer.reason);
  document["time_us"] = answer.time_us;
  return write(document);
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
  return write(document);
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
  return write(document);
}

Result<Eigen::Isometry3d> pose_from_json(std::string_view text) {
  try {
    return Document(text, "pose").any_root().pose();
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::json
