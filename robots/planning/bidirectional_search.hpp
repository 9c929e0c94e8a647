#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/planning/region_constraint.hpp"
#include "robots/planning/tree.hpp"

/// The search behind plan_birrt and plan_cbirrt2; for this library's sources only.
namespace kinship::planning {

/// The end of a tree's extension.
struct Extension {
  Eigen::Index node = 0;  ///< the last node
  bool reached = false;   ///< reached the target
};

/// The target of an extension: a sample may lie anywhere, a node of the other tree is a valid
/// configuration.
enum class Aim { Sample, Node };

/// \throws std::invalid_argument as plan_birrt; `planner` is its name in the message.
void check_arguments(const char* planner, const Eigen::VectorXd& start,
                     const Eigen::MatrixXd& goals, const ConfigurationSampler& sampler,
                     const BirrtOptions& options);

/// The summary of a search so far, but for what it counts itself.
PlanSummary summary_of(const PlanningBudget& budget, std::optional<Eigen::MatrixXd> path,
                       NoPath reason, FoundBy found_by);

/// The goals that hold a constraint.
/// \return empty, with a reason as in plan_cbirrt2, if the start or all goals do not.
std::optional<Eigen::MatrixXd> holding(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                       const RegionConstraint& constraint, NoPath& reason);

/// Plans along a constraint to the goals that hold it, and counts the projections.
/// \param plan  called with these goals, dof x n; returns a PlanSummary.
template <typename Plan>
PlanSummary plan_along(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const RegionConstraint& constraint, Plan plan) {
  PlanSummary summary;
  const auto reachable = holding(start, goals, constraint, summary.reason);
  if (!reachable)
    return summary;
  const std::uint64_t before = constraint.projections();
  summary = plan(*reachable);
  summary.projections = constraint.projections() - before;
  return summary;
}

/// A search with two trees, from the start and from every goal, that extends the smaller one.
/// \tparam Steering  extends from a node towards a target as far as possible: see steering.hpp.
template <typename Steering>
class BidirectionalSearch {
 public:
  BidirectionalSearch(const ConfigurationSampler& sampler, const BirrtOptions& options,
                      Steering& steering, PlanningBudget& budget, std::mt19937_64& generator)
      : sampler_(sampler),
        options_(options),
        steering_(steering),
        budget_(budget),
        samples_(sampler, generator) {
    trees_.record(options.recorder, budget);
  }

  BidirectionalSearch(const BidirectionalSearch&) = delete;
  BidirectionalSearch& operator=(const BidirectionalSearch&) = delete;
  ~BidirectionalSearch() {
    if (options_.trees != nullptr)
      *options_.trees = std::move(trees_);
  }

  /// Plants both trees and extends them until they meet or the budget is used up.
  PlanSummary run(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    Eigen::MatrixXd free_goals;
    if (auto answer = answer_at_once(start, goals, free_goals))
      return *std::move(answer);
    if (auto path = go_straight(free_goals))
      return summary(std::move(path), NoPath::None, FoundBy::StraightLine);
    return search();
  }

  /// Plants both trees. \return the summary if no search is needed.
  std::optional<PlanSummary> answer_at_once(const Eigen::VectorXd& start,
                                            const Eigen::MatrixXd& goals,
                                            Eigen::MatrixXd& free_goals) {
    const NoPath reason = trees_.plant(start, goals, budget_);
    if (reason != NoPath::None)
      return summary(std::nullopt, reason);
    free_goals.resize(goals.rows(), trees_.goal.size());
    for (Eigen::Index i = 0; i < trees_.goal.size(); ++i)
      free_goals.col(i) = trees_.goal.node(i);
    if (auto path = standstill())
      return summary(std::move(path), NoPath::None, FoundBy::StraightLine);
    return std::nullopt;
  }

  /// The same from started trees: the start or the free goals, and the configurations reached from
  /// them; all were checked.
  PlanSummary run_from(Tree start_tree, Tree goal_tree) {
    trees_.start = std::move(start_tree);
    trees_.goal = std::move(goal_tree);
    trees_.record(options_.recorder, budget_);
    return search();
  }

  /// The summary so far.
  PlanSummary summary(std::optional<Eigen::MatrixXd> path, NoPath reason,
                      FoundBy found_by = FoundBy::Search) {
    PlanSummary summary = summary_of(budget_, std::move(path), reason, found_by);
    summary.tracks_followed = next_track_;
    summary.iterations = iterations_;
    return summary;
  }

 private:
  PlanSummary search() {
    PlanSummary found = search_on();
    samples_.give_back();
    return found;
  }

  PlanSummary search_on() {
    const std::uint64_t begin = budget_.checks();
    while (!budget_.exhausted()) {
      const std::uint64_t spent = budget_.checks() - begin;
      const Track* const track = next_track(spent);
      auto path = track != nullptr ? follow(*track) : iterate(samples_before_track(spent));
      if (path)
        return summary(std::move(path), NoPath::None,
                       track != nullptr ? FoundBy::Track : FoundBy::Search);
    }
    return summary(std::nullopt, budget_.reason());
  }

  /// The path of a start that is a goal already.
  std::optional<Eigen::MatrixXd> standstill() const {
    const Eigen::VectorXd start = trees_.start.node(0);
    const Eigen::VectorXd goal = trees_.goal.node(trees_.goal.nearest(start));
    if (goal != start)
      return std::nullopt;
    Eigen::MatrixXd path(start.size(), 2);
    path << start, goal;
    return path;
  }

  /// Extends the start tree from its root towards one goal after the other, the nearest first. A
  /// free straight line is better than any sample. \return the path to the first goal reached.
  std::optional<Eigen::MatrixXd> go_straight(const Eigen::MatrixXd& goals) {
    const Eigen::VectorXd start = trees_.start.node(0);
    const Eigen::VectorXd distances = (goals.colwise() - start).colwise().norm();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(goals.cols()));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::stable_sort(order, {}, [&](Eigen::Index goal) { return distances[goal]; });
    constexpr std::uint64_t kMaxChecks = 100;
    const std::uint64_t end = budget_.checks() + kMaxChecks;
    for (const Eigen::Index goal : order) {
      if (budget_.checks() >= end || budget_.exhausted())
        return std::nullopt;
      const Extension there =
          steering_.extend(trees_.start, 0, goals.col(goal), Aim::Node, budget_);
      if (there.reached)
        return trees_.join(there.node, goal);
    }
    return std::nullopt;
  }

  /// The track to follow now. \param checks  of the search so far. \return null: none.
  const Track* next_track(std::uint64_t checks) {
    if (!is_track_due(checks))
      return nullptr;
    samples_.give_back();  // they come from around the tracks made so far
    const Track* const track = sampler_.tracks()->track(next_track_);
    has_tracks_ = track != nullptr;
    next_track_ += has_tracks_ ? 1 : 0;
    return track;
  }

  bool is_track_due(std::uint64_t checks) const {
    return has_tracks_ && static_cast<double>(track_checks_) <=
                              options_.track_check_fraction * static_cast<double>(checks);
  }

  /// How many samples may fail, a check each, before a track is due.
  Eigen::Index samples_before_track(std::uint64_t checks) const {
    std::uint64_t count = 1;
    while (count < SamplesAhead::kAhead && !is_track_due(checks + count))
      ++count;
    return static_cast<Eigen::Index>(count);
  }

  /// Extends the goal tree along a track until it is blocked, then the start tree towards its end.
  /// \return the path if they met.
  std::optional<Eigen::MatrixXd> follow(const Track& track) {
    const std::uint64_t before = budget_.checks();
    const Eigen::VectorXd root = track.configurations.col(0);
    Extension there{trees_.goal.nearest(root), true};
    if (trees_.goal.node(there.node) != root) {
      if (!track.is_goal_free)  // it collides
        return std::nullopt;
      there.node = trees_.goal.add(root, -1);
    }
    for (Eigen::Index i = 1; i < track.configurations.cols() && there.reached; ++i)
      there = steering_.extend(trees_.goal, there.node, track.configurations.col(i), Aim::Sample,
                               budget_);
    const Eigen::VectorXd tip = trees_.goal.node(there.node);
    const Extension met =
        steering_.extend(trees_.start, trees_.start.nearest(tip), tip, Aim::Node, budget_);
    track_checks_ += budget_.checks() - before;
    return met.reached ? std::optional(trees_.join(met.node, there.node)) : std::nullopt;
  }

  /// Extends the smaller tree towards samples until it grows, then the other towards its new end.
  /// \param ahead  maximum number of samples. \return the path if they met.
  std::optional<Eigen::MatrixXd> iterate(Eigen::Index ahead) {
    const bool start_grows = trees_.start.size() <= trees_.goal.size();
    Tree& grown = start_grows ? trees_.start : trees_.goal;
    Tree& other = start_grows ? trees_.goal : trees_.start;
    const std::optional<Extension> there = grow(grown, start_grows ? 0 : 1, ahead);
    if (!there)  // nothing new to go to
      return std::nullopt;
    tip_ = grown.node(there->node);
    const Extension met = steering_.extend(other, other.nearest(tip_), tip_, Aim::Node, budget_);
    if (!met.reached)
      return std::nullopt;
    return trees_.join(start_grows ? there->node : met.node, start_grows ? met.node : there->node);
  }

  /// Extends a tree towards samples until it grows. Until then each sample's extension begins as if
  /// it were the first: so the first configurations of several are checked together.
  /// \param which  index of the tree among the samples' nearest nodes. \return empty if it did not
  ///               grow.
  std::optional<Extension> grow(Tree& tree, std::size_t which, Eigen::Index ahead) {
    Eigen::Index asked = 0;
    spent_[0] = steering_.spent();
    begin(tree, which, ahead);
    for (Eigen::Index i = 0; i < ahead; ++i) {
      const Beginning& beginning = samples_.at(static_cast<std::uint64_t>(i)).beginnings[which];
      if (beginning.is_any) {
        firsts_.col(asked) = beginning.first;
        starts_[static_cast<std::size_t>(asked++)] = i;
      }
      spent_[static_cast<std::size_t>(i + 1)] =
          spent_[static_cast<std::size_t>(i)] + beginning.spent;
    }
    const std::uint64_t before = budget_.checks();
    const auto free = asked == 0 ? std::nullopt : budget_.first_free(firsts_.leftCols(asked));
    const auto answered = static_cast<Eigen::Index>(budget_.checks() - before);
    const Eigen::Index used =
        !free && answered == asked
            ? ahead
            : (answered == 0 ? 0 : starts_[static_cast<std::size_t>(answered - 1)] + 1);
    iterations_ += static_cast<std::uint64_t>(used);
    steering_.set_spent(spent_[static_cast<std::size_t>(used)]);
    if (!free) {
      samples_.use(static_cast<std::uint64_t>(used));
      return std::nullopt;
    }
    const Beginning& beginning =
        samples_.at(static_cast<std::uint64_t>(used - 1)).beginnings[which];
    const Extension there =
        steering_.extend_beyond(tree, beginning.near, beginning.first, beginning.target, budget_);
    samples_.use(static_cast<std::uint64_t>(used));
    return there;
  }

  using Beginning = SamplesAhead::Beginning;

  /// The beginnings of a tree's extensions towards samples: at the nearest node, towards a target
  /// beyond the sample.
  void begin(const Tree& tree, std::size_t which, Eigen::Index ahead) {
    std::size_t count = 0;
    for (Eigen::Index i = 0; i < ahead; ++i) {
      SamplesAhead::Sample& sample = samples_.at(static_cast<std::uint64_t>(i));
      const Eigen::Index near = tree.nearest(sample.q, sample.nearest[which]);
      Beginning& beginning = sample.beginnings[which];
      if (beginning.near == near)
        continue;
      beginning.near = near;
      beginning.target = (tree.node(near) + options_.overshoot * (sample.q - tree.node(near)))
                             .cwiseMax(lower_)
                             .cwiseMin(upper_);
      begun_[count++] = &beginning;
    }
    if (count > 0)
      steering_.begin(tree, std::span(begun_).first(count));
  }

  const ConfigurationSampler& sampler_;
  const BirrtOptions& options_;
  Steering& steering_;
  PlanningBudget& budget_;
  SamplesAhead samples_;
  const Eigen::VectorXd lower_ = sampler_.bounds().row(0), upper_ = sampler_.bounds().row(1);
  TreePair trees_{sampler_.bounds().cols()};
  bool has_tracks_ = sampler_.tracks() != nullptr && options_.track_check_fraction > 0;
  std::uint64_t iterations_ = 0;
  std::size_t next_track_ = 0;
  std::uint64_t track_checks_ = 0;
  // Of the samples ahead, a column each: kept, so that an iteration allocates nothing.
  Eigen::MatrixXd firsts_{sampler_.bounds().cols(), SamplesAhead::kAhead};
  std::array<Beginning*, SamplesAhead::kAhead> begun_{};
  std::array<Eigen::Index, SamplesAhead::kAhead> starts_{};      // samples that have a first one
  std::array<std::uint64_t, SamplesAhead::kAhead + 1> spent_{};  // before each sample, after all
  Eigen::VectorXd tip_;
};

}  // namespace kinship::planning
