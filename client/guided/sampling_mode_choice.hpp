#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "proto/evidence/attempt_window.hpp"
#include "proto/types/advice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::guided {

/// A user's options for guidance; missing ones follow the evidence.
struct SamplingModeOptions {
  std::optional<double> guided_fraction;   ///< of guided samples in a guided query, 0 to 1
  std::optional<double> control_fraction;  ///< of queries planned uniformly as control, 0 to 1
};

inline constexpr std::uint64_t kEarlyControls = 20;  ///< attempts after which fewer are forced
inline constexpr double kEarlyControlFloor = 0.1;
inline constexpr double kLateControlFloor = 0.02;
inline constexpr double kGuidedFloor = 0.02;  ///< so that improved guidance is noticed

/// Fraction of guided samples in a guided query: the user's, else the server's.
/// \throws std::invalid_argument if it is not 0 to 1.
double guided_fraction(const Advice& advice, const SamplingModeOptions& options);

/// Chooses, query by query, between planning guided and uniformly (control) for one (task, robot).
///
/// Thompson sampling: the chooser takes the mode that is cheaper in one draw from the posterior of
/// both costs (evidence::compare_costs); with two modes that is guided with the probability that
/// guidance is cheaper. The probability is kept at least kGuidedFloor; that of control at least
/// kEarlyControlFloor until kEarlyControls attempts of it are known, then kLateControlFloor. A
/// `control_fraction` replaces all that; a share of 0 plans every query uniformly, which gives no
/// evidence.
///
/// The evidence starts with the server's and grows with add(). With new advice a client makes a new
/// chooser and adds its own attempts that had no receipt at the time of the fetch: the advice
/// contains the others, so that none counts twice.
class SamplingModeChooser {
 public:
  /// \throws std::invalid_argument if a share is outside 0 to 1.
  SamplingModeChooser(const Advice& advice, const SamplingModeOptions& options);

  /// The mode of the next query that has guidance: Guided or Control, or Uniform at share 0. Equal
  /// seed and equal evidence give an equal mode.
  SamplingMode choose(std::uint64_t seed) const;

  /// Probability that the next query is guided.
  double guided_part() const;

  /// Adds the outcome of a query. Uniform attempts and those that could not be planned at all
  /// (Failed) are no evidence. The modes are compared anew once that costs at most 0.5 % of
  /// the time planned since, or the evidence has grown by a fourth: deciding takes 1 to 2 us a
  /// query where plans are cheap or guidance does not pay.
  ///
  /// \param time_s  see JudgedAttempt; 0: unknown.
  void add(SamplingMode mode, Outcome outcome, std::uint64_t checks, double time_s = 0);

  bool is_sampling() const noexcept { return !options_.control_fraction && !is_uniform(); }

 private:
  bool is_uniform() const noexcept { return options_.guided_fraction == 0.0; }
  bool is_belief_due() const;
  void compare();

  SamplingModeOptions options_;
  evidence::AttemptWindow window_;
  std::uint64_t guided_, control_;  // attempts known, of any age
  double guided_is_cheaper_ = 0;    // probability, when the modes were compared last
  std::size_t added_ = 0;           // attempts since then
  double planned_s_ = 0;            // time that these took
};

/// A seed that is equal for equal queries (name, start, goal, seed) and differs between others; it
/// is independent of the samples that a planner seeded with problem.seed draws.
std::uint64_t sampling_mode_seed(const Problem& problem);

}  // namespace kinship::guided
