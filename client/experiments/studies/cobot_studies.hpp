#pragma once

#include <vector>

#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// The studies with collaborative robots: `cobots` (the paper's second experiment) and
/// `open_table_cobots`.
std::vector<Study> cobot_studies();

}  // namespace kinship::experiments
