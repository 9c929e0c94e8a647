#pragma once

#include <vector>

#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// The family `furniture`: five cobots take something from furniture that stands elsewhere each
/// time, a study for each kind of furniture.
std::vector<Study> furniture_studies();

}  // namespace kinship::experiments
