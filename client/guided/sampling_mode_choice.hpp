#pragma once

#include <cstdint>
#include <optional>

#include "proto/evidence/attempt_window.hpp"
#include "proto/types/advice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// What a user says about guidance; what is missing follows the evidence.
struct SamplingModeOptions {
  std::optional<double> guided_fraction;   ///< of guided samples in a guided query, 0 to 1
  std::optional<double> control_fraction;  ///< of queries planned uniformly as control, 0 to 1
};

inline constexpr std::uint64_t kEarlyControls = 20;  ///< attempts after which fewer are forced
inline constexpr double kEarlyControlFloor = 0.1;
inline constexpr double kLateControlFloor = 0.02;
inline constexpr double kGuidedFloor = 0.02;  ///< so that guidance that became better is found out

/// Of guided samples in a guided query: what the user says, else what the server says.
/// \throws std::invalid_argument if it is not 0 to 1.
double guided_fraction(const Advice& advice, const SamplingModeOptions& options);

/// Chooses, query by query, between planning guided and uniformly (control) for one (task, robot).
///
/// Thompson sampling: the mode that is cheaper in one draw from what is believed of both costs
/// (evidence::compare_costs) is taken; with two modes that is guided with the probability that
/// guidance is cheaper. The probability is kept at least kGuidedFloor; that of control at least
/// kEarlyControlFloor until kEarlyControls attempts of it are known, then kLateControlFloor. A
/// `control_fraction` takes the place of all that; a share of 0 plans every query uniformly, which
/// is no evidence.
///
/// The evidence begins with the server's and goes on with add(). Who gets new advice makes a new
/// chooser and adds those of his own attempts that had no receipt when he asked: the others are in
/// the advice, and none counts twice.
class SamplingModeChooser {
 public:
  /// \throws std::invalid_argument if a share is outside 0 to 1.
  SamplingModeChooser(const Advice& advice, const SamplingModeOptions& options);

  /// The mode of the next query, guidance being there: Guided or Control, or Uniform at share 0.
  /// Equal seed and equal evidence, equal mode.
  SamplingMode choose(std::uint64_t seed) const;

  /// Probability that the next query is guided.
  double guided_part() const;

  /// What came of a query. Uniform attempts and those that could not be planned at all (Failed)
  /// teach nothing.
  void add(SamplingMode mode, Outcome outcome, std::uint64_t checks);

  bool is_sampling() const noexcept { return !options_.control_fraction && !is_uniform(); }

 private:
  bool is_uniform() const noexcept { return options_.guided_fraction == 0.0; }

  SamplingModeOptions options_;
  evidence::AttemptWindow window_;
  std::uint64_t guided_, control_;  // attempts known, of whatever age
};

/// A number that differs between queries (name, start, goal, seed) and is the same for the same
/// one; it says nothing about the samples that a planner seeded with problem.seed draws.
std::uint64_t sampling_mode_seed(const Problem& problem);

}  // namespace kinship::guided
