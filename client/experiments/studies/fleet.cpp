#include "client/experiments/studies/fleet.hpp"

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::vector<StudyMember> load_fleet(const Study& study, const std::filesystem::path& models) {
  std::vector<StudyMember> fleet;
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot =
        models::load_robot({.source = models / placed.model}).value_or_throw();
    fleet.push_back({placed,
                     robot,
                     {robot.chain, robot.shapes},
                     robot.chain.digest(),
                     study.make_instances(robot, placed)});
  }
  return fleet;
}

Problem read_instance(const StudyMember& member, std::uint64_t seed, std::uint32_t index) {
  return json::problem_from_json(json::to_json(member.draw(seed, index))).value_or_throw();
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

}  // namespace kinship::experiments
