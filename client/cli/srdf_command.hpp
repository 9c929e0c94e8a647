#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>

#include "robots/models/robot_arguments.hpp"

/// `robots suggest-srdf`, which needs no server.
namespace kinship::cli {

struct SuggestSrdfOptions {
  models::RobotArguments robot;  ///< without base and tip the likeliest ones are taken
  std::uint64_t samples = 10'000;
  std::uint64_t seed = 0;
  bool checks_default = false;        ///< also checks pairs that touch at zero
  std::filesystem::path output = {};  ///< empty: standard output
  bool json = false;                  ///< the findings, instead of an SRDF on standard output
  bool progress = false;
};

/// Samples which links touch, as MoveIt's setup assistant does, and writes an SRDF that disables
/// pairs of neighbours, pairs that always touch, that touch at zero and that never touch. Pairs
/// that touch in some samples stay checked.
int suggest_srdf(const SuggestSrdfOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
