#include "robots/planning/rrt_connect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/planning/tree.hpp"

namespace kinship::planning {
namespace {

// Of the dynamic domain, joint units: a node's first radius, its least one, and its change.
constexpr double kFirstRadius = 4, kLeastRadius = 1, kChange = 1e-4;

// One of so many samples is taken wherever it is: a tree that is shut in would take none.
constexpr std::uint64_t kMostRefused = 64;
constexpr Eigen::Index kRake = 8;  // configurations asked for together

/// A tree and how far from each node samples are taken: without end until a line was refused there.
struct Domain {
  double& radius(Eigen::Index node) {
    radii.resize(static_cast<std::size_t>(tree.size()), std::numeric_limits<double>::infinity());
    return radii[static_cast<std::size_t>(node)];
  }

  Tree& tree;
  std::vector<double> radii = {};
};

class Connecting {
 public:
  Connecting(const ConfigurationSampler& sampler, const BirrtOptions& options,
             PlanningBudget& budget, std::mt19937_64& generator)
      : sampler_(sampler),
        step_(options.step),
        budget_(budget),
        generator_(generator),
        trees_(sampler.bounds().cols()),
        sample_(sampler.bounds().cols()),
        asked_(sampler.bounds().cols(), kRake),
        wanted_trees_(options.trees) {
    trees_.record(options.recorder, budget);
  }
  Connecting(const Connecting&) = delete;
  Connecting& operator=(const Connecting&) = delete;
  ~Connecting() {
    if (wanted_trees_ != nullptr)
      *wanted_trees_ = std::move(trees_);
  }

  PlanSummary run(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    if (const NoPath reason = trees_.plant(start, goals, budget_); reason != NoPath::None)
      return summary(std::nullopt, reason);
    if (auto path = go_straight())
      return summary(std::move(path), NoPath::None, FoundBy::StraightLine);
    bool from_start = false;
    while (!budget_.exhausted()) {
      Domain &near = from_start ? start_ : goal_, &far = from_start ? goal_ : start_;
      if (std::abs(static_cast<double>(near.tree.size() - far.tree.size())) <
          static_cast<double>(near.tree.size()))
        from_start = !from_start;
      if (auto path = from_start ? iterate(start_, goal_) : iterate(goal_, start_))
        return summary(std::move(path), NoPath::None);
    }
    return summary(std::nullopt, budget_.reason());
  }

 private:
  PlanSummary summary(std::optional<Eigen::MatrixXd> path, NoPath reason,
                      FoundBy found_by = FoundBy::Search) const {
    PlanSummary summary = summary_of(budget_, std::move(path), reason, found_by);
    summary.iterations = iterations_;
    return summary;
  }

  /// Asks for configurations that are spread over the line, then for those between them.
  bool is_free(const Eigen::Ref<const Eigen::VectorXd>& from,
               const Eigen::Ref<const Eigen::VectorXd>& to) {
    direction_ = to - from;
    const auto rakes = std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(std::ceil(direction_.norm() / (step_ * kRake))));
    direction_ /= static_cast<double>(rakes * kRake);
    for (Eigen::Index rake = 0; rake < rakes; ++rake) {
      for (Eigen::Index i = 0; i < kRake; ++i)
        asked_.col(i).noalias() = from + static_cast<double>((i + 1) * rakes - rake) * direction_;
      if (!budget_.all_free(asked_))
        return false;
    }
    return true;
  }

  std::optional<Eigen::MatrixXd> go_straight() {
    constexpr Eigen::Index kMostGoals = 8;
    for (Eigen::Index i = 0; i < std::min(kMostGoals, trees_.goal.size()); ++i)
      if (is_free(trees_.start.node(0), trees_.goal.node(i))) {
        const Eigen::VectorXd goal = trees_.goal.node(i);
        return trees_.join(trees_.start.add(goal, 0), i);
      }
    return std::nullopt;
  }

  /// Extends a tree towards a sample, then on towards the nearest node of the other one.
  /// \return the path if it arrives.
  std::optional<Eigen::MatrixXd> iterate(Domain& grown, Domain& other) {
    ++iterations_;
    sampler_.draw(generator_, sampler_.guided_fraction(), sample_);
    const Eigen::Index near = grown.tree.nearest(sample_);
    way_ = sample_ - grown.tree.node(near);
    const double distance = way_.norm();
    double& radius = grown.radius(near);
    if (distance == 0 || (distance > radius && ++refused_ % kMostRefused != 0))
      return std::nullopt;
    if (distance > kConnectRange)
      sample_ = grown.tree.node(near) + way_ * (kConnectRange / distance);
    if (!is_free(grown.tree.node(near), sample_)) {
      radius = std::isinf(radius) ? kFirstRadius : std::max(radius * (1 - kChange), kLeastRadius);
      return std::nullopt;
    }
    if (!std::isinf(radius))
      radius *= 1 + kChange;
    return connect(grown, grown.tree.add(sample_, near), other);
  }

  std::optional<Eigen::MatrixXd> connect(Domain& grown, Eigen::Index node, Domain& other) {
    const Eigen::Index target = other.tree.nearest(sample_);
    from_ = sample_;
    way_ = other.tree.node(target) - from_;
    const double count = std::max(1.0, std::ceil(way_.norm() / kConnectRange));
    for (double i = 1; i <= count; ++i) {
      if (i < count)
        sample_ = from_ + way_ * (i / count);
      else
        sample_ = other.tree.node(target);
      if (!is_free(grown.tree.node(node), sample_))
        return std::nullopt;
      node = grown.tree.add(sample_, node);
    }
    return &grown == &start_ ? trees_.join(node, target) : trees_.join(target, node);
  }

  const ConfigurationSampler& sampler_;
  double step_;
  PlanningBudget& budget_;
  std::mt19937_64& generator_;
  TreePair trees_;
  Domain start_{trees_.start}, goal_{trees_.goal};
  std::uint64_t iterations_ = 0, refused_ = 0;
  // Kept, so that an iteration allocates little.
  Eigen::VectorXd sample_, from_, way_, direction_;
  Eigen::MatrixXd asked_;
  TreePair* wanted_trees_;
};

}  // namespace

PlanSummary plan_rrt_connect(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                             const IsFree& is_free, const ConfigurationSampler& sampler,
                             const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_rrt_connect", start, goals, sampler, options);
  PlanningBudget budget(is_free, options.max_checks, options.time_limit);
  return Connecting(sampler, options, budget, generator).run(start, goals);
}

}  // namespace kinship::planning
