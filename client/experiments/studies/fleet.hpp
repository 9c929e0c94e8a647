#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "client/guided/plan_problem.hpp"
#include "proto/types/digest.hpp"

namespace kinship::experiments {

/// A robot of a study, ready to plan.
struct StudyMember {
  StudyRobot placed;
  models::LoadedRobot robot;
  guided::PlannedRobot planned;  ///< the same as planning wants it
  Digest digest;
  DrawInstance draw;

  const std::string& label() const noexcept { return robot.description.label; }
};

/// An instance with the numbers that its line in a problem file gives (a pose changes in its last
/// bit when it is written and read): who repeats one plans the same.
Problem read_instance(const StudyMember& member, std::uint64_t seed, std::uint32_t index);

/// Every robot of a study, in its order.
/// \param models  folder of the robots' model folders.
/// \throws Failure(NotFound) and others of models::load_robot and Study::make_instances.
std::vector<StudyMember> load_fleet(const Study& study, const std::filesystem::path& models);

/// \throws Failure(NotFound) that names the robots there are.
std::size_t find_member(const std::vector<StudyMember>& fleet, std::string_view label);

}  // namespace kinship::experiments
