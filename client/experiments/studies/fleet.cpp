#include "client/experiments/studies/fleet.hpp"

#include <nlohmann/json.hpp>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/json/format.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"

namespace kinship::experiments {

std::vector<StudyMember> load_fleet(const Study& study, const std::filesystem::path& models) {
  std::vector<StudyMember> fleet;
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot =
        models::load_robot({.source = models / placed.model}).value_or_throw();
    fleet.push_back({placed, robot, robot.chain.digest(), study.make_instances(robot, placed)});
  }
  return fleet;
}

std::size_t find_member(const std::vector<StudyMember>& fleet, std::string_view label) {
  std::string labels;
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    if (fleet[i].label() == label)
      return i;
    labels += (labels.empty() ? "" : ", ") + fleet[i].label();
  }
  throw Failure(ErrorCode::NotFound,
                "no robot '" + std::string(label) + "' in the study; there are " + labels);
}

namespace {

nlohmann::ordered_json describe_joint(const kinematics::Joint& joint) {
  nlohmann::ordered_json document;
  document["type"] = joint.type == kinematics::JointType::Prismatic ? "prismatic" : "revolute";
  document["T_previous_joint"] = to_pose_array(joint.T_previous_joint);
  document["axis"] = {joint.axis.x(), joint.axis.y(), joint.axis.z()};
  return document;
}

nlohmann::ordered_json describe_robot(const StudyMember& member) {
  const kinematics::Chain& chain = member.robot.chain;
  nlohmann::ordered_json document;
  document["label"] = member.label();
  document["digest"] = member.digest.hex();
  document["T_task_base"] = to_pose_array(member.placed.T_task_base);
  for (const kinematics::Joint& joint : chain.joints())
    document["joints"].push_back(describe_joint(joint));
  document["T_last_transfer"] = to_pose_array(chain.T_last_tip() * chain.T_tip_transfer());
  const Problem problem = member.draw(seed_of(InstanceSet::Test, 0), 0);
  document["scene"] = nlohmann::ordered_json::parse(json::to_json(problem)).at("scene");
  return document;
}

}  // namespace

std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet) {
  nlohmann::ordered_json document;
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
  return json::in_format({"study-description"}, document.dump()) + "\n";
}

}  // namespace kinship::experiments
