#include "server/catalog/advice_rule.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "proto/evidence/cost_ratio.hpp"

namespace kinship::catalog {
namespace {

// Probabilities that guidance is cheaper. kNoShare is the higher for the prior's part in it.
constexpr double kNoShare = 0.4, kFullShare = 0.7;
constexpr double kQuantile90 = 1.6449;  // two-sided, of the normal distribution

std::optional<ModeEvidence> evidence_of(const store::ModeTotals& totals) {
  if (totals.attempts == 0)
    return std::nullopt;
  ModeEvidence mode{totals.attempts, totals.solved, 0};
  if (totals.solved > 0)
    mode.checks_per_solution = totals.checks / static_cast<double>(totals.solved);
  return mode;
}

std::string text(const char* format, double value) {
  char words[32];
  std::snprintf(words, sizeof words, format, value);
  return words;
}

std::string describe(const char* mode, const char* unit, const store::ModeTotals& totals) {
  const std::string attempts = std::to_string(totals.attempts);
  if (totals.solved == 0)
    return std::string(mode) + " none solved in " + attempts;
  return mode + text(" %.0f", totals.checks / static_cast<double>(totals.solved)) + unit + " in " +
         attempts;
}

std::string describe(const evidence::CostRatio& ratio) {
  const double better = ratio.guided_is_cheaper;
  const std::string words = std::string(ratio.is_by_time ? "by processor time, " : "") +
                            "typical ratio uniform / guided " + text("%.2f", ratio.quantile(0)) +
                            text(" (90 %% %.2f", ratio.quantile(-kQuantile90)) +
                            text(" to %.2f)", ratio.quantile(kQuantile90));
  if (better >= kFullShare)
    return words + ", better: share of the profile";
  if (better <= kNoShare)
    return words + ", worse: uniform";
  return words + ", undecided: part of the profile's share";
}

}  // namespace

Advice advise(const store::AttemptTotals& totals, JudgedAttempts judged, double profile_share) {
  Advice advice;
  advice.guided_share = std::clamp(profile_share, 0.0, 1.0);
  advice.recommended_share = advice.guided_share;
  advice.guided = evidence_of(totals.guided);
  advice.control = evidence_of(totals.control);
  advice.recent = std::move(judged.attempts);
  if (std::min(judged.guided, judged.control) < kMinAttempts) {
    const std::string needed = std::to_string(kMinAttempts);
    advice.evidence = "default; a measured one needs " + needed + " guided and " + needed +
                      " control attempts with this profile and these engines, there are " +
                      std::to_string(judged.guided) + " and " + std::to_string(judged.control);
    return advice;
  }
  const evidence::CostRatio ratio = evidence::compare_costs(advice.recent);
  if (!ratio.is_compared) {
    advice.evidence =
        "a mode has no attempts that report processor time or collision checks: share of the "
        "profile";
    return advice;
  }
  advice.recommended_share *=
      std::clamp((ratio.guided_is_cheaper - kNoShare) / (kFullShare - kNoShare), 0.0, 1.0);
  advice.evidence = describe("guided", " checks per solution", totals.guided) + " attempts, " +
                    describe("control", "", totals.control) + "; " + describe(ratio);
  return advice;
}

}  // namespace kinship::catalog
