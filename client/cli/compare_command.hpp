#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/rehearsal.hpp"

namespace kinship::cli {

struct CompareOptions {
  std::string task;
  std::vector<std::string> targets;        ///< labels or beginnings of digests; empty: every robot
  std::vector<std::string> placements;     ///< "LABEL=x y z qx qy qz qw", before what was reported
  std::chrono::milliseconds wait{120000};  ///< for one pair of robots
  bool json = false;
};

/// What the experience of one robot is worth to another on a task, as the server's rehearsal
/// predicts it before the target has planned.
struct Transferability {
  Digest target, source;
  std::string target_label, source_label;
  std::optional<Rehearsal> rehearsal;  ///< none: see `message`
  std::string message;                 ///< why there is none, or what it lacks
};

/// Checks without guidance to checks with the best guide of a rehearsal, means; none if it planned
/// nothing.
std::optional<double> worth(const Rehearsal& rehearsal);

/// A matrix, a target a row: what each source is worth, the best one of a row with an asterisk.
void print_worths(const std::vector<Transferability>& pairs, std::ostream& out);

/// `robots compare`: has the server plan the recorded queries of each source again for each target,
/// and prints what came of it. \return kNotFound for a task or robot that the server does not know,
///         kFailed if a pair could not be told within `wait`.
int compare_robots(link::Client& server, const CompareOptions& options, std::ostream& out,
                   std::ostream& err);

}  // namespace kinship::cli
