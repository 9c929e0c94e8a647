#pragma once

#include <string>

#include "client/experiments/page/page_data.hpp"

namespace kinship::experiments {

/// What the page's program reads: lengths as whole millimetres, directions as whole percents.
std::string to_json(const PageData& data);

}  // namespace kinship::experiments
