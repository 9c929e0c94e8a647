#pragma once

#include <chrono>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/transferability.hpp"

namespace kinship::cli {

struct CompareOptions {
  std::string task;
  std::vector<std::string> targets;        ///< labels or beginnings of digests; empty: every robot
  std::vector<std::string> placements;     ///< "LABEL=x y z qx qy qz qw", instead of reported ones
  std::chrono::milliseconds wait{120000};  ///< for one pair of robots
  bool json = false;
  bool progress = false;              ///< each pair is named on `err`
  std::filesystem::path output = {};  ///< of a page; "-": `out`, without a matrix; empty: no page
};

/// A matrix of the sources' worth, a target per row, the best source of a row with an asterisk.
void print_worths(const std::vector<Transferability>& pairs, std::ostream& out);

/// `robots compare`: makes the server plan the recorded queries of each source again for each
/// target, and prints the comparison.
/// \return kNotFound for a task or robot that the server does not know, kFailed if a pair was not
///         compared within `wait`.
int compare_robots(link::Client& server, const CompareOptions& options, std::ostream& out,
                   std::ostream& err);

}  // namespace kinship::cli
