#include "client/planning/birrt.hpp"

#include <stdexcept>
#include <utility>

#include "client/planning/tree.hpp"

namespace kinship::planning {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTolerance = 1e-9;  // joint units: no last step as short as rounding

/// Asks whether configurations are free until checks or time are used up.
class Budget {
 public:
  Budget(const IsFree& is_free, const BirrtOptions& options)
      : is_free_(is_free), options_(options), begin_(Clock::now()) {}

  /// False also if the budget is used up; then nothing was asked.
  bool is_free(const Eigen::VectorXd& q) {
    if (exhausted())
      return false;
    ++checks_;
    return is_free_(q);
  }

  bool exhausted() {
    if (reason_.empty() && checks_ >= options_.max_checks)
      reason_ = "checks";
    if (reason_.empty() && elapsed_s() >= options_.time_limit.count())
      reason_ = "time";
    return !reason_.empty();
  }

  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  std::uint64_t checks() const { return checks_; }
  const std::string& reason() const { return reason_; }

 private:
  const IsFree& is_free_;
  const BirrtOptions& options_;
  Clock::time_point begin_;
  std::uint64_t checks_ = 0;
  std::string reason_;
};

struct Extension {
  Eigen::Index node = 0;  // the last one
  bool reached = false;   // the target
};

/// Extends the tree from node `from` straight to the target, as far as it is free.
Extension extend(Tree& tree, Eigen::Index from, const Eigen::VectorXd& target, double step,
                 Budget& budget) {
  const Eigen::VectorXd origin = tree.node(from);
  const double distance = (target - origin).norm();
  if (distance == 0)
    return {from, true};
  const Eigen::VectorXd direction = (target - origin) / distance;
  for (int i = 1;; ++i) {
    const bool last = i * step >= distance - kTolerance;
    const Eigen::VectorXd q = last ? target : Eigen::VectorXd(origin + i * step * direction);
    if (!budget.is_free(q))
      return {from, false};
    from = tree.add(q, from);
    if (last)
      return {from, true};
  }
}

void check_arguments(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                     const ConfigurationSampler& sampler, const BirrtOptions& options) {
  const Eigen::Index dof = sampler.bounds().cols();
  if (dof < 1 || start.size() != dof || (goals.cols() > 0 && goals.rows() != dof))
    throw std::invalid_argument("plan_birrt: start, goals and bounds differ in size");
  if (!start.allFinite() || !goals.allFinite())
    throw std::invalid_argument("plan_birrt: start or goals are not finite");
  if (!(options.step > 0) || !(options.overshoot >= 1))
    throw std::invalid_argument("plan_birrt: step must be positive, overshoot at least 1");
}

class Birrt {
 public:
  Birrt(const ConfigurationSampler& sampler, const BirrtOptions& options, Budget& budget,
        std::mt19937_64& generator)
      : sampler_(sampler), options_(options), budget_(budget), generator_(generator) {}

  /// \return why there is nothing to plan, or an empty text.
  std::string plant(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    if (goals.cols() == 0)
      return "no goal";
    if (!budget_.is_free(start))
      return budget_.exhausted() ? budget_.reason() : "start collides";
    start_tree_.add(start, -1);
    for (Eigen::Index i = 0; i < goals.cols(); ++i)
      if (budget_.is_free(goals.col(i)))
        goal_tree_.add(goals.col(i), -1);
    if (budget_.exhausted())
      return budget_.reason();
    return goal_tree_.size() == 0 ? "every goal collides" : "";
  }

  /// The path of a start that is a goal already.
  std::optional<Eigen::MatrixXd> standstill() const {
    const Eigen::VectorXd start = start_tree_.node(0);
    const Eigen::VectorXd goal = goal_tree_.node(goal_tree_.nearest(start));
    if (goal != start)
      return std::nullopt;
    Eigen::MatrixXd path(start.size(), 2);
    path << start, goal;
    return path;
  }

  /// One extension of each tree. \return the path if they met.
  std::optional<Eigen::MatrixXd> iterate() {
    Tree& grown = grow_start_ ? start_tree_ : goal_tree_;
    Tree& other = grow_start_ ? goal_tree_ : start_tree_;
    grow_start_ = !grow_start_;
    const Eigen::VectorXd sample = sampler_.sample(generator_);
    const Eigen::Index near = grown.nearest(sample);
    const Extension there =
        extend(grown, near, overshoot(grown.node(near), sample), options_.step, budget_);
    const Eigen::VectorXd tip = grown.node(there.node);
    const Extension met = extend(other, other.nearest(tip), tip, options_.step, budget_);
    if (!met.reached)
      return std::nullopt;
    const bool start_grew = &grown == &start_tree_;
    return join(start_grew ? there.node : met.node, start_grew ? met.node : there.node);
  }

 private:
  Eigen::VectorXd overshoot(const Eigen::VectorXd& near, const Eigen::VectorXd& sample) const {
    const Eigen::VectorXd target = near + options_.overshoot * (sample - near);
    return target.cwiseMax(sampler_.bounds().row(0).transpose())
        .cwiseMin(sampler_.bounds().row(1).transpose());
  }

  /// The path over two nodes that hold the same configuration.
  Eigen::MatrixXd join(Eigen::Index start_node, Eigen::Index goal_node) const {
    const Eigen::MatrixXd from_start = start_tree_.branch(start_node).rowwise().reverse();
    const Eigen::MatrixXd to_goal = goal_tree_.branch(goal_node);
    Eigen::MatrixXd path(from_start.rows(), from_start.cols() + to_goal.cols() - 1);
    path << from_start, to_goal.rightCols(to_goal.cols() - 1);
    return path;
  }

  const ConfigurationSampler& sampler_;
  const BirrtOptions& options_;
  Budget& budget_;
  std::mt19937_64& generator_;
  Tree start_tree_{sampler_.bounds().cols()};
  Tree goal_tree_{sampler_.bounds().cols()};
  bool grow_start_ = true;
};

}  // namespace

PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments(start, goals, sampler, options);
  Budget budget(is_free, options);
  Birrt birrt(sampler, options, budget, generator);
  PlanSummary summary;
  summary.reason = birrt.plant(start, goals);
  if (summary.reason.empty())
    summary.waypoints = birrt.standstill();
  while (summary.reason.empty() && !summary.waypoints && !budget.exhausted()) {
    ++summary.iterations;
    summary.waypoints = birrt.iterate();
  }
  if (!summary.waypoints && summary.reason.empty())
    summary.reason = budget.reason();
  summary.collision_checks = budget.checks();
  summary.planning_time_s = budget.elapsed_s();
  return summary;
}

}  // namespace kinship::planning
