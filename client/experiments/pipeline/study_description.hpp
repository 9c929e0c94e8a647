#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/experiments/pipeline/fleet.hpp"

namespace kinship::experiments {

/// A study as its analysis wants to know it, one JSON document: name, settings, side studies, and
/// of each robot where it stands, its chain, and the scene of its first test instance. \param
/// learning_instances  of each robot, in this run.
std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet,
                           std::uint32_t learning_instances);

}  // namespace kinship::experiments
