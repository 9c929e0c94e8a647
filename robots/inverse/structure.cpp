#include "robots/inverse/structure.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/elimination.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/inverse/task_rank.hpp"

namespace kinship::inverse {
namespace {

constexpr double kDistinct = 0.02;  // sine or distance: less is too close to make use of
constexpr int kLockTrials = 3;      // a structure must hold at as many values of the locks
constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::size_t kFreeJoints = 6;

using SixAxes = std::array<Axis, kFreeJoints>;

double sine_between(const Axis& a, const Axis& b) { return a.direction.cross(b.direction).norm(); }

double distance_from(const Axis& axis, const Eigen::Vector3d& x) {
  return (x - axis.foot_of(x)).norm();
}

/// The point nearest to lines that are not all parallel.
template <std::size_t n>
Eigen::Vector3d meeting_point(const std::array<const Axis*, n>& axes) {
  Eigen::Matrix3d across_all = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Axis* axis : axes) {
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - axis->direction * axis->direction.transpose();
    across_all += across;
    sum += across * axis->point;
  }
  return across_all.ldlt().solve(sum);
}

template <std::size_t n>
double distance_from_all(const std::array<const Axis*, n>& axes, const Eigen::Vector3d& x) {
  double largest = 0;
  for (const Axis* axis : axes)
    largest = std::max(largest, distance_from(*axis, x));
  return largest;
}

bool meet_distinctly(const Axis& a, const Axis& b) { return sine_between(a, b) > kDistinct; }

/// Three axes that place a point, in the order in which a rule looks at them.
struct Placing {
  Axis *first, *second, *third;
  bool meet;
};

Placing placing(SixAxes& axes, PointRule rule) {
  const bool meet = rule == PointRule::FirstMeet || rule == PointRule::LastMeet;
  if (rule == PointRule::FirstMeet || rule == PointRule::FirstParallel)
    return {&axes[0], &axes[1], &axes[2], meet};
  return {&axes[2], &axes[1], &axes[0], meet};
}

/// Makes parallel axes so: one direction for all, or its opposite.
template <std::size_t n>
double make_parallel(const std::array<Axis*, n>& axes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Axis* axis : axes)
    sum += axis->direction.dot(axes[0]->direction) > 0 ? axis->direction
                                                       : Eigen::Vector3d(-axis->direction);
  const Eigen::Vector3d direction = sum.normalized();
  double deviation = 0;
  for (Axis* axis : axes) {
    deviation = std::max(deviation, axis->direction.cross(direction).norm());
    axis->direction = axis->direction.dot(direction) > 0 ? direction : Eigen::Vector3d(-direction);
  }
  return deviation;
}

/// Makes axes meet: one point for all.
template <std::size_t n>
double make_meet(const std::array<Axis*, n>& axes) {
  std::array<const Axis*, n> lines;
  std::copy(axes.begin(), axes.end(), lines.begin());
  const Eigen::Vector3d point = meeting_point(lines);
  const double deviation = distance_from_all(lines, point);
  for (Axis* axis : axes)
    axis->point = point;
  return deviation;
}

double fit_point_rule(const Placing& by, const Eigen::Vector3d& wrist, bool wrist_turns) {
  if (by.meet) {
    if (!meet_distinctly(*by.first, *by.second))
      return kNone;
    const double deviation = make_meet<2>({by.first, by.second});
    if (distance_from(*by.third, by.first->point) < kDistinct)
      return kNone;  // the turn about it leaves the distance as it is: the pose fixes it
    return wrist_turns && distance_from(*by.third, wrist) < kDistinct ? kNone : deviation;
  }
  const double deviation = make_parallel<2>({by.first, by.second});
  if (distance_between(*by.first, *by.second) < kDistinct ||
      sine_between(*by.first, *by.third) < kDistinct)
    return kNone;
  return wrist_turns && distance_from(*by.third, wrist) < kDistinct ? kNone : deviation;
}

/// Moves six axes onto a rule (not reversed).
/// \return by how much they deviated; kNone if the rule cannot serve.
double fit(SixAxes& axes, const SixJointRule& rule) {
  if (std::ranges::any_of(axes, &Axis::prismatic))
    return kNone;
  if (rule.kind == SixJointRule::Kind::ThreeParallel) {
    const double parallel = make_parallel<3>({&axes[1], &axes[2], &axes[3]});
    if (parallel > kNearStructure || !meet_distinctly(axes[4], axes[5]) ||
        sine_between(axes[3], axes[4]) < kDistinct || sine_between(axes[0], axes[1]) < kDistinct ||
        distance_between(axes[1], axes[2]) < kDistinct ||
        distance_between(axes[2], axes[3]) < kDistinct)
      return kNone;
    return std::max(parallel, make_meet<2>({&axes[4], &axes[5]}));
  }
  if (!meet_distinctly(axes[3], axes[4]) || !meet_distinctly(axes[4], axes[5]))
    return kNone;
  const double wrist = make_meet<3>({&axes[3], &axes[4], &axes[5]});
  if (wrist > kNearStructure)
    return kNone;
  const Placing by = placing(axes, rule.point);
  return std::max(wrist, fit_point_rule(by, axes[5].point, by.third == &axes[2]));
}

double fit_either_way(SixAxes& axes, const SixJointRule& rule) {
  if (!rule.reversed)
    return fit(axes, rule);
  std::ranges::reverse(axes);
  const double deviation = fit(axes, rule);
  std::ranges::reverse(axes);
  return deviation;
}

std::vector<SixJointRule> all_rules() {
  using enum PointRule;
  using Kind = SixJointRule::Kind;
  std::vector<SixJointRule> rules;
  for (const bool reversed : {false, true})
    for (const PointRule point : {FirstParallel, LastParallel, FirstMeet, LastMeet})
      rules.push_back({Kind::SphericalWrist, reversed, point});
  for (const bool reversed : {false, true})
    rules.push_back({Kind::ThreeParallel, reversed});
  return rules;
}

/// Values for locks that no two axes are aligned at by chance.
std::array<double, kMaxLocked> lock_values(int trial) {
  return {0.37 + 1.31 * trial, -1.13 + 0.83 * trial};
}

/// The free axes once the axes before them have been locked, and the displacement of each of them.
struct Carried {
  SixAxes axes;
  std::array<Displacement, kFreeJoints> by;
  std::array<int, kFreeJoints> joints;
};

Carried carry(const std::vector<Axis>& axes, const std::vector<int>& locks, const double* values) {
  Carried carried;
  Displacement by;
  std::size_t next_free = 0;
  std::size_t next_lock = 0;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    if (next_lock < locks.size() && locks[next_lock] == static_cast<int>(j)) {
      by = by * axes[j].at(values[next_lock++]);
      continue;
    }
    carried.axes[next_free] = axes[j].moved(by);
    carried.by[next_free] = by;
    carried.joints[next_free++] = static_cast<int>(j);
  }
  return carried;
}

double deviation_of(const AxisChain& chain, const std::vector<int>& locks,
                    const SixJointRule& rule) {
  double deviation = 0;
  for (int trial = 0; trial < (locks.empty() ? 1 : kLockTrials); ++trial) {
    Carried carried = carry(chain.axes, locks, lock_values(trial).data());
    deviation = std::max(deviation, fit_either_way(carried.axes, rule));
    if (deviation > kNearStructure)
      return kNone;
  }
  return deviation;
}

/// The chain's axes, each moved onto the rule.
std::vector<Axis> obedient_axes(const AxisChain& chain, const std::vector<int>& locks,
                                const SixJointRule& rule) {
  Carried carried = carry(chain.axes, locks, lock_values(0).data());
  fit_either_way(carried.axes, rule);
  std::vector<Axis> axes = chain.axes;
  for (std::size_t i = 0; i < kFreeJoints; ++i)
    axes[static_cast<std::size_t>(carried.joints[i])] =
        carried.axes[i].moved(carried.by[i].inverse());
  return axes;
}

/// All ascending choices of `count` joints out of `dof`.
std::vector<std::vector<int>> choices(int dof, int count) {
  if (count == 0)
    return {{}};
  std::vector<std::vector<int>> result;
  for (const std::vector<int>& shorter : choices(dof, count - 1))
    for (int joint = shorter.empty() ? 0 : shorter.back() + 1; joint < dof; ++joint) {
      result.push_back(shorter);
      result.back().push_back(joint);
    }
  return result;
}

std::string lock_text(std::span<const int> locks) {
  std::string text;
  for (const int joint : locks)
    text += (text.empty() ? "lock q" : ", q") + std::to_string(joint + 1);
  return text.empty() ? text : text + "; ";
}

std::string deviation_text(const ClosedForm& form) {
  if (form.exact())
    return "";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), " (off by %.0e)", form.deviation());
  return text.data();
}

std::string form_text(const ClosedForm& form) {
  return form.structure_name() + deviation_text(form) + "; " + lock_text(form.locks()) +
         (form.exact() ? "closed form, " : "closed form of the nominal chain and polish, ") +
         std::to_string(form.branches()) + " branches" + (form.locks().empty() ? "" : " per lock");
}

std::string missing_text(const kinematics::Chain& chain) {
  const auto wanted = std::ranges::count(chain.task_axes().matters, true);
  const Eigen::Index rank = task_rank(chain);
  if (rank >= wanted)
    return "";
  return "; " + std::to_string(chain.dof()) +
         (chain.dof() == 1 ? " joint moves " : " joints move ") + "the transfer frame in " +
         std::to_string(rank) + " of " + std::to_string(wanted) +
         " task axes: poses off that set have no solution";
}

}  // namespace

std::vector<SixJointStructure> six_joint_structures(const AxisChain& chain) {
  std::vector<SixJointStructure> structures;
  const int dof = static_cast<int>(chain.axes.size());
  if (dof < static_cast<int>(kFreeJoints) || dof > static_cast<int>(kFreeJoints) + kMaxLocked)
    return structures;
  static const std::vector<SixJointRule> kRules = all_rules();
  for (std::vector<int>& locks : choices(dof, dof - static_cast<int>(kFreeJoints))) {
    SixJointStructure best;
    best.deviation = kNone;
    for (const SixJointRule& rule : kRules) {
      const double deviation = deviation_of(chain, locks, rule);
      if (std::max(deviation, kExactStructure) < best.deviation) {
        best.deviation = std::max(deviation, kExactStructure);
        best.rule = rule;
      }
    }
    if (best.deviation == kNone)
      continue;
    best.axes = obedient_axes(chain, locks, best.rule);
    best.locks = std::move(locks);
    structures.push_back(std::move(best));
  }
  return structures;
}

void lock(const std::vector<Axis>& axes, const std::vector<int>& locks, const double* values,
          SixJointTask& task) {
  if (locks.empty()) {
    std::copy(axes.begin(), axes.end(), task.axes.begin());
    return;
  }
  // Either the axes behind the locks are carried along, or the axes before them are carried back,
  // whichever are fewer.
  if (locks.front() >= static_cast<int>(axes.size()) - 1 - locks.back()) {
    Displacement by;
    std::size_t next = 0;
    std::size_t i = 0;
    for (std::size_t j = 0; j < axes.size(); ++j) {
      if (next < locks.size() && locks[next] == static_cast<int>(j))
        by = by * axes[j].at(values[next++]);
      else
        task.axes[i++] = next == 0 ? axes[j] : axes[j].moved(by);
    }
    task.wanted = task.wanted * by.inverse();
    return;
  }
  Displacement back;  // inverse of the product of the locks from here on
  std::size_t left = locks.size();
  std::size_t i = kFreeJoints;
  for (std::size_t j = axes.size(); j-- > 0;) {
    if (left > 0 && locks[left - 1] == static_cast<int>(j)) {
      --left;
      back = back * axes[j].at(-values[left]);
    } else {
      task.axes[--i] = left == locks.size() ? axes[j] : axes[j].moved(back);
    }
  }
  task.wanted = back * task.wanted;
}

std::optional<CommonDirection> common_direction(const AxisChain& chain) {
  CommonDirection common;
  common.direction = chain.axes.front().direction;
  for (const Axis& axis : chain.axes) {
    if (axis.prismatic)
      return std::nullopt;
    common.deviation = std::max(common.deviation, axis.direction.cross(common.direction).norm());
  }
  if (common.deviation > kNearStructure)
    return std::nullopt;
  return common;
}

std::string describe_structure(const kinematics::Chain& chain) {
  const ClosedFormFinding finding = find_closed_form(chain);
  std::string text;
  if (finding.form)
    text = form_text(*finding.form);
  else if (finding.left_out)
    text = finding.left_out->structure_name() + deviation_text(*finding.left_out) + "; " +
           lock_text(finding.left_out->locks()) +
           "closed form left out, random locks seldom lead within limits; numeric";
  else if (elimination_of(chain, lane_chain(chain), instruction_sets().back().kernels))
    text = "no closed form; elimination and polish, at most 16 branches";
  else
    text = "no closed form; numeric";
  return text + missing_text(chain);
}

}  // namespace kinship::inverse
