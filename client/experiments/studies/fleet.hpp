#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "proto/types/digest.hpp"

namespace kinship::experiments {

/// A robot of a study, ready to plan.
struct StudyMember {
  StudyRobot placed;
  models::LoadedRobot robot;
  Digest digest;
  DrawInstance draw;

  const std::string& label() const noexcept { return robot.description.label; }
};

/// Every robot of a study, in its order.
/// \param models  folder of the robots' model folders.
/// \throws Failure(NotFound) and others of models::load_robot and Study::make_instances.
std::vector<StudyMember> load_fleet(const Study& study, const std::filesystem::path& models);

/// \throws Failure(NotFound) that names the robots there are.
std::size_t find_member(const std::vector<StudyMember>& fleet, std::string_view label);

/// A study as the programs that run and analyse it want to know it, one JSON document: name,
/// settings, and of each robot where it stands, its chain, and the scene of its first test
/// instance.
std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet);

}  // namespace kinship::experiments
