#include "robots/planning/rrt_connect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
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

/// A tree and how far from each node samples are taken.
struct Domain {
  explicit Domain(Eigen::Index dof) : tree(dof) {}

  Eigen::Index add(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index parent) {
    radii.push_back(std::numeric_limits<double>::infinity());
    return tree.add(q, parent);
  }
  double& radius(Eigen::Index node) { return radii[static_cast<std::size_t>(node)]; }

  Tree tree;
  std::vector<double> radii;
};

class Connecting {
 public:
  Connecting(const ConfigurationSampler& sampler, const BirrtOptions& options,
             PlanningBudget& budget, std::mt19937_64& generator)
      : sampler_(sampler),
        step_(options.step),
        budget_(budget),
        generator_(generator),
        recorder_(options.recorder),
        start_(sampler.bounds().cols()),
        goal_(sampler.bounds().cols()),
        sample_(sampler.bounds().cols()),
        asked_(sampler.bounds().cols(), kRake) {
    if (recorder_ == nullptr)
      return;
    recorder_->begin(budget);
    start_.tree.record(*recorder_, SearchRecorder::Side::Start);
    goal_.tree.record(*recorder_, SearchRecorder::Side::Goal);
  }

  PlanSummary run(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    if (const NoPath reason = plant(start, goals); reason != NoPath::None)
      return summary(std::nullopt, reason, FoundBy::Nothing);
    if (auto path = go_straight())
      return summary(std::move(path), NoPath::None, FoundBy::StraightLine);
    bool from_start = false;
    while (!budget_.exhausted()) {
      Domain &near = from_start ? start_ : goal_, &far = from_start ? goal_ : start_;
      if (std::abs(static_cast<double>(near.tree.size() - far.tree.size())) <
          static_cast<double>(near.tree.size()))
        from_start = !from_start;
      if (auto path = from_start ? iterate(start_, goal_) : iterate(goal_, start_))
        return summary(std::move(path), NoPath::None, FoundBy::Search);
    }
    return summary(std::nullopt, budget_.reason(), FoundBy::Nothing);
  }

 private:
  PlanSummary summary(std::optional<Eigen::MatrixXd> path, NoPath reason, FoundBy found_by) const {
    PlanSummary summary;
    summary.waypoints = std::move(path);
    summary.collision_checks = budget_.checks();
    summary.iterations = iterations_;
    summary.found_by = found_by;
    summary.planning_time_s = budget_.thread_time_s();
    summary.reason = reason;
    return summary;
  }

  NoPath plant(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    if (goals.cols() == 0)
      return NoPath::NoGoal;
    if (!budget_.is_free(start))
      return budget_.exhausted() ? budget_.reason() : NoPath::StartCollides;
    start_.add(start, -1);
    for (const auto& goal : goals.colwise())
      if (budget_.is_free(goal))
        goal_.add(goal, -1);
    if (budget_.exhausted())
      return budget_.reason();
    return goal_.tree.size() == 0 ? NoPath::GoalsCollide : NoPath::None;
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
    for (Eigen::Index i = 0; i < std::min(kMostGoals, goal_.tree.size()); ++i)
      if (is_free(start_.tree.node(0), goal_.tree.node(i))) {
        const Eigen::VectorXd goal = goal_.tree.node(i);
        return join(start_.add(goal, 0), i);
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
    return connect(grown, grown.add(sample_, near), other);
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
      node = grown.add(sample_, node);
    }
    return &grown == &start_ ? join(node, target) : join(target, node);
  }

  /// The path over two nodes that hold the same configuration.
  Eigen::MatrixXd join(Eigen::Index start_node, Eigen::Index goal_node) const {
    if (recorder_ != nullptr)
      recorder_->join(start_node, goal_node);
    const Eigen::MatrixXd from_start = start_.tree.branch(start_node).rowwise().reverse();
    const Eigen::MatrixXd to_goal = goal_.tree.branch(goal_node);
    Eigen::MatrixXd path(from_start.rows(), from_start.cols() + to_goal.cols() - 1);
    path << from_start, to_goal.rightCols(to_goal.cols() - 1);
    return path;
  }

  const ConfigurationSampler& sampler_;
  double step_;
  PlanningBudget& budget_;
  std::mt19937_64& generator_;
  SearchRecorder* recorder_;
  Domain start_, goal_;
  std::uint64_t iterations_ = 0, refused_ = 0;
  // Kept, so that an iteration allocates little.
  Eigen::VectorXd sample_, from_, way_, direction_;
  Eigen::MatrixXd asked_;
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
