#include "client/experiments/studies/study_description.hpp"

#include <nlohmann/json.hpp>

#include "client/experiments/studies/instance_draws.hpp"
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

std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet) {
  Json document;
  document["study"] = study.name;
  document["purpose"] = study.purpose;
  if (!study.family.empty())
    document["family"] = study.family;
  document["is_constrained"] = study.is_constrained;
  document["learning_instances"] = study.learning_instances;
  document["test_instances"] = study.test_instances;
  document["test_seeds"] = kTestSeeds;
  document["resolution"] = study.settings.resolution;
  document["overshoot"] = study.settings.overshoot;
  document["guided_share"] = study.guided_share;
  document["max_checks"] = study.settings.max_checks;
  document["max_goals"] = study.settings.max_goals;
  for (const StudyMember& member : fleet)
    document["robots"].push_back(describe_robot(member));
  return document.dump() + "\n";
}

}  // namespace kinship::experiments
