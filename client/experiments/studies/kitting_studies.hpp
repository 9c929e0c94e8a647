#pragma once

#include <vector>

#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// `kitting`: five cobots put parts from a worktable into the ten compartments of a rack.
std::vector<Study> kitting_studies();

}  // namespace kinship::experiments
