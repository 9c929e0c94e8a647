#include "server/rehearsal/rehearse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "proto/types/duration_text.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/split_mix.hpp"
#include "proto/types/stopped.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/recall/recall.hpp"

namespace kinship::rehearsal {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// In the order of their preparation before the first sample: the mixture costs most. To recall
/// costs less than the next one.
constexpr std::array kByEffort = {
    Guide::None,    Guide::Retreat,        Guide::Ways,        Guide::RetreatWays,
    Guide::Mixture, Guide::RetreatMixture, Guide::WaysMixture, Guide::RetreatWaysMixture};

std::ptrdiff_t effort_of(const GuideCost& cost) {
  const auto at = std::ranges::find(kByEffort, without_recall(cost.guide)) - kByEffort.begin();
  return 2 * at + (has_recall(cost.guide) ? 1 : 0);
}

/// The configuration that a query asked for, as far as that is known.
Eigen::MatrixXd drawn_goal(const RecordedQuery& query, const Eigen::MatrixXd& goals) {
  if (query.own)
    return query.own->rightCols<1>();
  return goals.col(static_cast<Eigen::Index>(split_mixed(query.path.bytes.front()) %
                                             static_cast<std::uint64_t>(goals.cols())));
}

}  // namespace

Guide cheapest(std::span<const GuideCost> costs) {
  constexpr double kAsGood = 1.03;
  const bool is_timed =
      std::ranges::all_of(costs, [](const GuideCost& cost) { return cost.mean_time_s > 0; });
  double GuideCost::*const mean = is_timed ? &GuideCost::mean_time_s : &GuideCost::mean_checks;
  const auto as_good = [](std::vector<const GuideCost*> of, const auto& cost_of) {
    const double enough =
        kAsGood *
        cost_of(*std::ranges::min(of, {}, [&](const GuideCost* cost) { return cost_of(*cost); }));
    std::erase_if(of, [&](const GuideCost* cost) { return cost_of(*cost) > enough; });
    return of;
  };
  const auto of_search = [&](const GuideCost& cost) {
    const auto search = std::ranges::find(costs, without_recall(cost.guide), &GuideCost::guide);
    return (search == costs.end() ? cost : *search).*mean;
  };
  std::vector<const GuideCost*> best;
  for (const GuideCost& cost : costs)
    best.push_back(&cost);
  best = as_good(std::move(best), [&](const GuideCost& cost) { return cost.*mean; });
  best = as_good(std::move(best), of_search);
  return (*std::ranges::min_element(best, {},
                                    [](const GuideCost* cost) { return effort_of(*cost); }))
      ->guide;
}

std::string described(const std::vector<GuideCost>& costs) {
  std::string text;
  for (const GuideCost& cost : costs)
    text += (text.empty() ? "; mean time " : ", ") + std::string(to_text(cost.guide)) + " " +
            duration_text(cost.mean_time_s) + " (" +
            std::to_string(std::llround(cost.mean_checks)) + " checks)";
  return text;
}

std::size_t half_of(const Uuid& path) { return path.bytes.back() % kHalves; }

Rehearsing::Rehearsing(Subject subject, const RehearsalOptions& options)
    : subject_(std::move(subject)),
      options_(options),
      is_usable_(subject_.recorded.queries.size(), true) {
  const bool are_mixtures = std::ranges::all_of(
      subject_.mixtures, [](const auto& mixture) { return mixture.has_value(); });
  const bool are_ways = !subject_.experience->experience().paths.empty();
  for (const Guide guide : kByEffort)
    if ((are_mixtures || !has_mixture(guide)) && (are_ways || !has_ways(guide)))
      guides_.push_back({guide, {}, {}, false});
}

bool Rehearsing::step() {
  if (is_done())
    return false;
  std::optional<PosedQuery> posed =
      pose_query(*subject_.robot, subject_.T_task_base, subject_.recorded.queries[next_],
                 subject_.starts, Branch::Drawn);
  if (posed && subject_.to_configuration)
    posed->query.goals = drawn_goal(subject_.recorded.queries[next_], posed->query.goals);
  is_usable_[next_] = posed.has_value();
  const std::uint64_t seed = split_mixed((next_ * options_.rounds + round_ + 1) * kSplitMixStep);
  std::vector<recall::Warp> failed;
  const std::optional<Cost> recalled = posed ? recall(*posed, failed) : std::nullopt;
  std::vector<std::pair<TriedGuide*, Costs>> all;
  bool is_solved = false;
  for (std::size_t i = 0; posed && i < guides_.size(); ++i) {
    TriedGuide& tried = guides_[(i + next_ + round_) % guides_.size()];  // the first: cold caches
    if (tried.is_left)
      continue;
    all.emplace_back(&tried, try_guide(*posed, seed, tried.guide, recalled, failed));
    const Costs& costs = all.back().second;
    is_solved =
        is_solved || costs.alone.is_solved || (costs.after_recall && costs.after_recall->is_solved);
  }
  // A drawn configuration that nothing reaches is none that a robot asks for.
  const bool is_drawn = subject_.to_configuration && !subject_.recorded.queries[next_].own;
  if (is_drawn && !is_solved && round_ == 0)
    is_usable_[next_] = false;
  for (const auto& [tried, costs] : all) {
    if (!is_usable_[next_])
      break;
    tried->alone.add(costs.alone);
    if (costs.after_recall)
      tried->after_recall.add(*costs.after_recall);
  }
  ++next_;
  advance();
  return true;
}

/// \param recalled  what it cost to try; nothing: there is nothing to recall.
/// \param failed    paths that were tried in vain.
Rehearsing::Costs Rehearsing::try_guide(PosedQuery& posed, std::uint64_t seed, Guide guide,
                                        const std::optional<Cost>& recalled,
                                        std::vector<recall::Warp>& failed) const {
  posed.query.failed_paths = {};
  Costs costs{plan(posed, seed, guide), recalled};
  if (!recalled || recalled->is_solved)
    return costs;
  Cost planned = costs.alone;
  if (planned.has_used_tracks && !failed.empty()) {
    posed.query.failed_paths = [&failed] { return recall::whole(failed); };
    planned = plan(posed, seed, guide);
  }
  planned.checks += recalled->checks;
  planned.time_s += recalled->time_s;
  costs.after_recall = planned;
  return costs;
}

bool Rehearsing::is_done() const { return round_ >= options_.rounds || next_ == is_usable_.size(); }

/// To the next query that can be planned, if need be in the next round.
void Rehearsing::advance() {
  const auto find = [this](std::size_t from) {
    return static_cast<std::size_t>(
        std::find(is_usable_.begin() + static_cast<std::ptrdiff_t>(from), is_usable_.end(), true) -
        is_usable_.begin());
  };
  next_ = find(next_);
  if (next_ < is_usable_.size())
    return;
  end_round();
  ++round_;
  next_ = find(0);
}

void Rehearsing::Tried::add(const Cost& cost) {
  checks.push_back(cost.checks);
  time_s += cost.time_s;
  solved += cost.is_solved ? 1U : 0U;
}

/// \return nothing if there is nothing to recall.
std::optional<Rehearsing::Cost> Rehearsing::recall(PosedQuery& posed,
                                                   std::vector<recall::Warp>& failed) const {
  if (!subject_.recall)
    return std::nullopt;
  const planning::TrackQuery& planned = posed.query;
  recall::Query query{planned.T_task_base, planned.bounds, planned.start, {}};
  if (subject_.to_configuration)
    query.goals = planned.goals;
  else
    query.T_base_goal = kinematics::T_base_transfer(subject_.robot->chain, planned.goals.col(0));
  query.T_task_anchors =
      recall::find_anchors(subject_.recall->library().anchors, posed.surroundings.scene.objects);
  query.constraint = posed.constraint ? &*posed.constraint : nullptr;
  query.without = planned.without;
  const planning::IsFree is_free =
      planning::free_in(*posed.world, [this] { throw_if_stopped(options_.stop); });
  const double begin_s = planning::thread_time_s();
  recall::RecallSummary summary =
      recall::recall(*subject_.recall, query, is_free, {.step = subject_.recorded.steps.step});
  const double time_s = planning::thread_time_s() - begin_s;
  failed = std::move(summary.failed);
  return Cost{static_cast<double>(summary.collision_checks), time_s, summary.waypoints.has_value()};
}

Rehearsing::Cost Rehearsing::plan(PosedQuery& posed, std::uint64_t seed, Guide guide) const {
  const double begin_s = planning::thread_time_s();
  const std::optional<Mixture>& mixture = subject_.mixtures.at(half_of(*posed.query.without));
  const planning::GuidedSampler guided =
      planning::guided_sampler(subject_.robot->chain, posed.query, mixture ? &*mixture : nullptr,
                               subject_.experience, {.guide = guide});
  const planning::IsFree is_free =
      planning::free_in(*posed.world, [this] { throw_if_stopped(options_.stop); });
  planning::BirrtOptions options;
  options.step = subject_.recorded.steps.step;
  options.overshoot = subject_.recorded.steps.overshoot;
  options.max_checks = options_.max_checks;
  std::mt19937_64 generator(seed);
  const planning::PlanSummary summary =
      planning::plan_trees(posed.query.start, posed.query.goals,
                           {is_free, posed.constraint ? &*posed.constraint : nullptr},
                           guided.sampler, options, generator);
  return {static_cast<double>(summary.collision_checks), planning::thread_time_s() - begin_s,
          summary.waypoints.has_value(),
          summary.tracks_followed > 0 && summary.found_by != FoundBy::Track};
}

void Rehearsing::end_round() {
  constexpr std::size_t kEnough = 20;
  constexpr double kHopeless = 1.5;
  double best = std::numeric_limits<double>::infinity();
  for (const TriedGuide& tried : guides_)
    if (tried.alone.checks.size() >= kEnough && !tried.is_left)
      best = std::min(best, tried.alone.mean_time_s());
  for (TriedGuide& tried : guides_)
    tried.is_left = tried.is_left || (tried.alone.checks.size() >= kEnough &&
                                      tried.alone.mean_time_s() > kHopeless * best);
}

Rehearsal Rehearsing::result() const {
  Rehearsal result;
  result.is_complete = is_done();
  const auto add = [&result](Guide guide, const Tried& tried) {
    if (!tried.checks.empty())
      result.costs.push_back({.guide = guide,
                              .plans = tried.checks.size(),
                              .solved = tried.solved,
                              .mean_checks = mean(tried.checks),
                              .median_checks = median(tried.checks),
                              .mean_time_s = tried.mean_time_s()});
  };
  for (const TriedGuide& tried : guides_) {
    add(tried.guide, tried.alone);
    add(with_recall(tried.guide), tried.after_recall);
  }
  result.queries = static_cast<std::uint64_t>(std::ranges::count(is_usable_, true));
  result.left_out = is_usable_.size() - result.queries;
  if (result.queries == 0) {
    result.guide = Guide::None;  // where others went leads nowhere
    result.message = "no recorded query can be planned by this robot where it stands";
  }
  if (round_ > 0 && !result.costs.empty())
    result.guide = cheapest(result.costs);
  std::ranges::sort(result.costs, {}, &GuideCost::guide);
  return result;
}

}  // namespace kinship::rehearsal
