#pragma once

#include <string>

#include "proto/types/problem.hpp"

namespace kinship::planner {

/// A result as one line for people, without line end: what came of it, what it cost, guided by what
/// or why not.
std::string result_text(const ProblemResult& result);

}  // namespace kinship::planner
