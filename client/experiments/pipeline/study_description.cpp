#include "client/experiments/pipeline/study_description.hpp"

#include <nlohmann/json.hpp>

#include "client/experiments/pipeline/side_study.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/pose.hpp"

namespace kinship::experiments {
namespace {

using Json = nlohmann::ordered_json;

Json describe_joint(const kinematics::Joint& joint) {
  Json document;
  document["type"] = joint.type == kinematics::JointType::Prismatic ? "prismatic" : "revolute";
  document["T_previous_joint"] = to_pose_array(joint.T_previous_joint);
  document["axis"] = {joint.axis.x(), joint.axis.y(), joint.axis.z()};
  return document;
}

Json describe_robot(const StudyMember& member) {
  const kinematics::Chain& chain = member.robot.chain;
  Json document;
  document["label"] = member.label();
  document["digest"] = member.digest.hex();
  document["T_task_base"] = to_pose_array(member.placed.T_task_base);
  for (const kinematics::Joint& joint : chain.joints())
    document["joints"].push_back(describe_joint(joint));
  document["T_last_transfer"] = to_pose_array(chain.T_last_tip() * chain.T_tip_transfer());
  const Problem problem = member.draw(seed_of(InstanceSet::Test, 0), 0);
  document["scene"] = Json::parse(json::to_json(problem)).at("scene");
  return document;
}

}  // namespace

std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet,
                           std::uint32_t learning_instances) {
  Json document;
  document["study"] = study.name;
  document["purpose"] = study.purpose;
  if (!study.family.empty())
    document["family"] = study.family;
  document["uniform"] = uniform_name(study.settings.overshoot);
  document["is_constrained"] = study.is_constrained;
  document["learning_instances"] = learning_instances;
  document["resolution"] = study.settings.resolution;
  document["overshoot"] = study.settings.overshoot;
  document["guided_share"] = study.guided_share;
  document["max_checks"] = study.settings.max_checks;
  for (const SideStudy& side : side_studies(study))
    document["side_studies"].push_back({{"name", side.name}, {"purpose", side.purpose}});
  for (const StudyMember& member : fleet)
    document["robots"].push_back(describe_robot(member));
  return document.dump() + "\n";
}

}  // namespace kinship::experiments
