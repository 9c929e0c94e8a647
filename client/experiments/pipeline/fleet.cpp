#include "client/experiments/pipeline/fleet.hpp"

#include <utility>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

/// Instances with the numbers that a problem file gives, so that who repeats one plans the same.
DrawInstance as_written(DrawInstance draw) {
  return [draw = std::move(draw)](std::uint64_t seed, std::uint32_t index) {
    return json::problem_from_json(json::to_json(draw(seed, index))).value_or_throw();
  };
}

}  // namespace

std::vector<StudyMember> load_fleet(const Study& study, const std::filesystem::path& models) {
  std::vector<StudyMember> fleet;
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot =
        models::load_robot({.source = models / placed.model}).value_or_throw();
    fleet.push_back({placed,
                     robot,
                     {robot.chain, robot.shapes},
                     robot.chain.digest(),
                     as_written(study.make_instances(robot, placed))});
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

}  // namespace kinship::experiments
