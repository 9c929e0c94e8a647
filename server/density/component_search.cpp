#include "server/density/component_search.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/density/merge.hpp"

namespace kinship::density {
namespace {

constexpr std::array kComponents = {96, 64, 50, 40, 30, 20, 14, 10, 7, 5, 3, 2, 1};
constexpr int kIterationsPerStep = 30;
constexpr int kLowScoresToEnd = 3;    // in a row
constexpr double kLowScore_nats = 1;  // below the best

}  // namespace

ComponentSearch prune_components(Mixture start, const BlockPoints& training,
                                 const BlockPoints& held_out, double log_uniform,
                                 const EmOptions& options) {
  const auto score_of = [&](const Mixture& mixture) {
    return mean_log_density(mixture, held_out, kBackgroundShare, log_uniform, options.computation);
  };
  EmOptions step_options = options;
  step_options.max_iterations = std::min(options.max_iterations, kIterationsPerStep);
  Mixture current = run_em(std::move(start), training, options).mixture;
  ComponentSearch search{{}, current, score_of(current)};
  search.curve.push_back({static_cast<int>(current.size()), search.best_score});
  int low = 0;
  for (const int components : kComponents) {
    if (components >= current.size())
      continue;
    try {
      current =
          run_em(merged(current, components, options.computation.stop), training, step_options)
              .mixture;
    } catch (const Failure&) {
      break;  // too wide beside its floor to be factored, as fewer would be
    }
    const double score = score_of(current);
    search.curve.push_back({static_cast<int>(current.size()), score});
    low = score < search.best_score - kLowScore_nats ? low + 1 : 0;
    if (score > search.best_score) {
      search.best = current;
      search.best_score = score;
    }
    if (low == kLowScoresToEnd)
      break;
  }
  return search;
}

}  // namespace kinship::density
