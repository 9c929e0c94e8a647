#pragma once

#include <optional>
#include <string>

#include "proto/types/digest.hpp"
#include "proto/types/rehearsal.hpp"

namespace kinship {

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

}  // namespace kinship
