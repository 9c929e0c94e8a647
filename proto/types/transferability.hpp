#pragma once

#include <optional>
#include <string>

#include "proto/types/digest.hpp"
#include "proto/types/rehearsal.hpp"

namespace kinship {

/// Worth of one robot's experience to another on a task, predicted by the server's rehearsal before
/// the target has planned.
struct Transferability {
  Digest target, source;
  std::string target_label, source_label;
  std::optional<Rehearsal> rehearsal;  ///< none: see `message`
  std::string message;                 ///< why there is no rehearsal, or what it lacks
};

/// Ratio of the mean checks without guidance to those with the best guide of a rehearsal; missing
/// without such plans.
std::optional<double> worth(const Rehearsal& rehearsal);

}  // namespace kinship
