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

/// Worth of experience: mean cost of the best guide that needs none (see needs_experience) to that
/// of the best guide that uses it. Above 1 experience pays; what the retreat saves is not booked as
/// its own.
struct Worth {
  std::optional<double> by_time;  ///< processor time of everything; missing: a time is unknown
  double by_checks = 0;           ///< collision checks, each guide the best by these
  Guide without = Guide::None;    ///< the best guides, by time, by checks where one is unknown
  Guide with = Guide::Ways;

  double value() const { return by_time.value_or(by_checks); }  ///< what counts
};

/// \return missing without plans of both kinds that needed checks.
std::optional<Worth> worth(const Rehearsal& rehearsal);

}  // namespace kinship
