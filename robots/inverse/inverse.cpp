#include "robots/inverse/inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"

namespace kinship::inverse {
namespace {

constexpr double kSamePoint = 1e-3;  // joint units: closer ones are the same solution
constexpr int kMostSolutions = 1000;
constexpr int kIterations = 15;         // measured: more cost more than they bring
constexpr int kPatientIterations = 40;  // for poses that no ordinary start has solved
constexpr int kPatientStarts = 16;
constexpr int kFewestStarts = 32;
constexpr int kStartsPerSolution = 4;
constexpr int kMostStarts = 4000;
constexpr int kFirstStarts = 16;
constexpr int kDiagnosticStarts = 8;
constexpr int kSaturated = 96;  // starts in a row without a new solution
constexpr double kNear = 0.1;   // task error (m and rad) worth more patience
constexpr double kFar = 1e-2;   // task error of a pose that is not just hard

/// One call of `inverse`: the starts of one pose and what came of them.
class Search {
 public:
  Search(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
         const InverseOptions& options)
      : chain_(chain),
        descent_(chain),
        T_base_transfer_(T_base_tip * chain.T_tip_transfer()),
        most_solutions_(options.max_solutions == 0
                            ? kMostSolutions
                            : std::min(options.max_solutions, kMostSolutions)),
        min_distance_(std::max(options.min_distance, kSamePoint)),
        generator_(options.seed, T_base_tip) {}

  InverseSolutions run(const InverseOptions& options) {
    const bool all = options.max_solutions == 0;
    const int starts =
        all ? kMostStarts : std::max(kFewestStarts, kStartsPerSolution * most_solutions_);
    const int patience = all ? kSaturated : starts;
    if (beyond_reach())
      return solutions();
    const int first = std::min(starts, kFirstStarts);
    start(first, Descent::Limits::Steer, kIterations, first);
    if (found_.empty() && !promising())
      return solutions();
    start(starts - first, Descent::Limits::Steer, kIterations, patience);
    if (found_.empty())
      start(kPatientStarts, Descent::Limits::Steer, kPatientIterations, kPatientStarts);
    return solutions();
  }

 private:
  bool beyond_reach() const {
    Eigen::Vector3d p = T_base_transfer_.translation() - descent_.p_base_first_joint();
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (!chain_.task_axes().matters[static_cast<std::size_t>(axis)])
        p[axis] = 0;
    return p.norm() > descent_.reach_m() + kPoseTolerance;
  }

  bool enough() const { return static_cast<int>(found_.size()) == most_solutions_; }

  /// Runs up to `count` starts, until there are enough solutions or `patience` starts in a row
  /// have brought no new one.
  void start(int count, Descent::Limits limits, int iterations, int patience) {
    for (int i = 0, idle = 0; i < count && idle < patience && !enough(); ++i) {
      JointVector q = random_start();
      const double squared = descent_.run(T_base_transfer_, limits, iterations, q);
      least_squared_error_ = std::min(least_squared_error_, squared);
      idle = squared < kPoseTolerance * kPoseTolerance && accept(q) ? 0 : idle + 1;
    }
  }

  /// Nothing found so far: learns without regard to limits what stands in the way.
  bool promising() {
    start(kDiagnosticStarts, Descent::Limits::Ignore, kIterations, kDiagnosticStarts);
    return !found_.empty() || least_squared_error_ < kNear * kNear;
  }

  /// Uniform within the limits; within a turn around mid-range where they are wider.
  JointVector random_start() {
    JointVector q(chain_.dof());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const kinematics::Joint& joint = chain_.joints()[static_cast<std::size_t>(j)];
      const double middle = 0.5 * (joint.lower + joint.upper);
      double half = 0.5 * (joint.upper - joint.lower);
      if (joint.type != kinematics::JointType::Prismatic)
        half = std::min(half, std::numbers::pi);
      q[j] = middle + (2 * generator_.uniform() - 1) * half;
    }
    return q;
  }

  /// Takes a converged configuration if it is within limits, far enough from those found before
  /// and right by the forward kinematics of the chain itself.
  bool accept(JointVector& q) {
    if (!normalize(chain_, q)) {
      outside_limits_ = true;
      return false;
    }
    for (const JointVector& other : found_)
      if (distance(chain_, q, other) < min_distance_)
        return false;
    if (!reaches(chain_, T_base_transfer_, q))
      return false;
    found_.push_back(q);
    return true;
  }

  InverseSolutions solutions() const {
    InverseSolutions result;
    result.configurations.resize(chain_.dof(), static_cast<Eigen::Index>(found_.size()));
    for (std::size_t i = 0; i < found_.size(); ++i)
      result.configurations.col(static_cast<Eigen::Index>(i)) = found_[i];
    if (!found_.empty())
      return result;
    if (outside_limits_)
      result.reason = NoSolution::Limits;
    else if (least_squared_error_ > kFar * kFar)
      result.reason = NoSolution::OutOfReach;
    else
      result.reason = NoSolution::NotConverged;
    return result;
  }

  const kinematics::Chain& chain_;
  Descent descent_;
  Eigen::Isometry3d T_base_transfer_;
  int most_solutions_;
  double min_distance_;
  CounterGenerator generator_;
  std::vector<JointVector> found_;
  bool outside_limits_ = false;
  double least_squared_error_ = std::numeric_limits<double>::infinity();
};

}  // namespace

InverseSolutions inverse(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
                         const InverseOptions& options) {
  if (!T_base_tip.matrix().allFinite())
    throw std::invalid_argument("inverse: the pose of the tip link is not finite");
  if (options.max_solutions < 0)
    throw std::invalid_argument("inverse: max_solutions must not be negative");
  if (!(options.min_distance >= 0))
    throw std::invalid_argument("inverse: min_distance must be 0 or more");
  return Search(chain, T_base_tip, options).run(options);
}

std::string solver_name(const kinematics::Chain& /*chain*/) {
  return "multi-start Levenberg-Marquardt";
}

}  // namespace kinship::inverse
