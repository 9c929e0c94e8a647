#include "server/density/ladder.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/density/merge.hpp"

namespace kinship::density {
namespace {

constexpr std::array kRungs = {96, 64, 50, 40, 30, 20, 14, 10, 7, 5, 3, 2, 1};
constexpr int kIterationsPerRung = 30;
constexpr int kLowRungsToEnd = 3;     // in a row
constexpr double kLowScore_nats = 1;  // below the best

}  // namespace

Ladder climb_down(const BlockPoints& training, const BlockPoints& held_out, Eigen::Index most,
                  double log_uniform, std::uint64_t seed, const EmOptions& options) {
  const auto score_of = [&](const Mixture& mixture) {
    return mean_log_density(mixture, held_out, kBackgroundShare, log_uniform, options.computation);
  };
  EmOptions rung_options = options;
  rung_options.max_iterations = std::min(options.max_iterations, kIterationsPerRung);
  Mixture current = run_em(start_mixture(training, most, seed, options), training, options).mixture;
  Ladder ladder{{}, current, score_of(current)};
  ladder.curve.push_back({static_cast<int>(current.size()), ladder.best_score});
  int low = 0;
  for (const int rung : kRungs) {
    if (rung >= current.size())
      continue;
    try {
      current = run_em(merged(current, rung), training, rung_options).mixture;
    } catch (const Failure&) {
      break;  // too wide beside its floor to be factored, as fewer would be
    }
    const double score = score_of(current);
    ladder.curve.push_back({static_cast<int>(current.size()), score});
    low = score < ladder.best_score - kLowScore_nats ? low + 1 : 0;
    if (score > ladder.best_score) {
      ladder.best = current;
      ladder.best_score = score;
    }
    if (low == kLowRungsToEnd)
      break;
  }
  return ladder;
}

}  // namespace kinship::density
