#pragma once

#include <vector>

#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// The studies with planar arms: `planar` (the paper's first experiment), `planar_p1` and
/// `open_table`.
std::vector<Study> planar_studies();

}  // namespace kinship::experiments
