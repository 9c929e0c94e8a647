#pragma once

#include <string>
#include <vector>

#include "client/experiments/studies/fleet.hpp"

namespace kinship::experiments {

/// A study as the programs that run and analyse it want to know it, one JSON document: name,
/// settings, and of each robot where it stands, its chain, and the scene of its first test
/// instance.
std::string describe_study(const Study& study, const std::vector<StudyMember>& fleet);

}  // namespace kinship::experiments
