#include "robots/inverse/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "proto/types/turn.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::inverse {
namespace {

constexpr std::size_t kJoints = 6;
static_assert(kLaneLocks == kMaxLocked);

/// "5-6-7": joints counted from 1, as people do.
std::string joint_range(int first, int second, int third) {
  return std::to_string(first + 1) + "-" + std::to_string(second + 1) + "-" +
         std::to_string(third + 1);
}

constexpr int kTrials = 32;
constexpr double kSmallestSlack = 1e-7;
constexpr double kSlackPerDeviation = 4;
constexpr double kRecovered_rad = 1e-4;       // of an exact structure; singular poses are coarse
constexpr double kNearlyRecovered_rad = 0.3;  // before the polish
constexpr double kRecoveredShare = 0.9;
constexpr double kNearlyRecoveredShare = 0.5;
constexpr std::uint64_t kSeed = 0x6b696e;
constexpr int kMaxPlanarChoices = 60;
constexpr double kBetter = 1.15;  // less than that is chance, and the first choice stands

using Configuration = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, static_cast<int>(kMaxDof), 1>;

/// Random configurations within the limits and the poses that they reach.
struct Samples {
  std::vector<Configuration> configurations;
  std::vector<Eigen::Isometry3d> poses;
};

Configuration random_configuration(const kinematics::Chain& chain, CounterGenerator& generator) {
  Configuration q(chain.dof());
  for (Eigen::Index j = 0; j < q.size(); ++j)
    q[j] = chain.lower()[j] + generator.uniform() * (chain.upper()[j] - chain.lower()[j]);
  return q;
}

Samples sample(const kinematics::Chain& chain) {
  Samples samples;
  CounterGenerator generator(kSeed);
  for (int i = 0; i < kTrials; ++i) {
    samples.configurations.push_back(random_configuration(chain, generator));
    samples.poses.push_back(kinematics::T_base_transfer(chain, samples.configurations.back()));
  }
  return samples;
}

double largest_difference(const kinematics::Chain& chain, const double* a, const Configuration& b) {
  double largest = 0;
  for (Eigen::Index j = 0; j < b.size(); ++j) {
    const bool turns =
        chain.joints()[static_cast<std::size_t>(j)].type != kinematics::JointType::Prismatic;
    const double difference = a[j] - b[j];
    largest = std::max(largest, std::abs(turns ? wrapped(difference) : difference));
  }
  return largest;
}

std::vector<int> others(int dof, const std::vector<int>& joints) {
  std::vector<int> rest;
  for (int j = 0; j < dof; ++j)
    if (!std::ranges::binary_search(joints, j))
      rest.push_back(j);
  return rest;
}

/// Which joints of a planar arm may be left free: every ascending choice while they are few, else
/// neighbours.
std::vector<std::vector<int>> planar_choices(int dof, int count) {
  std::vector<std::vector<int>> result;
  for (int a = 0; a < dof; ++a)
    for (int b = a + 1; b < dof; ++b) {
      if (count == 2)
        result.push_back({a, b});
      for (int c = b + 1; c < dof && count == 3; ++c)
        result.push_back({a, b, c});
    }
  if (result.size() > kMaxPlanarChoices)
    std::erase_if(result, [](const std::vector<int>& free) {
      return free.back() - free.front() >= static_cast<int>(free.size());
    });
  return result;
}

/// A locked arm for the kernels, if two neighbours of the three axes that place its wrist meet.
/// \param windows  of the free joints.
std::optional<LaneWrist> lane_wrist(const SixJointStructure& six,
                                    const std::vector<TurnWindow>& windows, double slack) {
  const SixJointRule& rule = six.rule;
  const bool meet = rule.point == PointRule::FirstMeet || rule.point == PointRule::LastMeet;
  if (six.locks.empty() || !meet || rule.kind != SixJointRule::Kind::SphericalWrist)
    return std::nullopt;
  LaneWrist lanes{};
  const int count = lanes.count = static_cast<int>(six.axes.size());
  lanes.locks = static_cast<int>(six.locks.size());
  const auto place_of = [&](int joint) { return rule.reversed ? count - 1 - joint : joint; };
  for (int joint = 0; joint < count; ++joint) {
    const Axis& axis = six.axes[static_cast<std::size_t>(joint)];
    LaneWrist::Axis& lane = lanes.axes[place_of(joint)];
    std::copy_n(axis.direction.data(), 3, lane.direction);
    std::copy_n(axis.point.data(), 3, lane.point);
    lane.slides = axis.prismatic;
    lane.locked = std::ranges::binary_search(six.locks, joint);
  }
  const int front = place_of(rule.reversed ? six.locks.back() : six.locks.front());
  const int back = place_of(rule.reversed ? six.locks.front() : six.locks.back());
  lanes.carries_on = front >= count - 1 - back;
  lanes.last_meet = rule.point == PointRule::LastMeet;
  const auto last = std::ranges::find(std::rbegin(lanes.axes) + (6 + kLaneLocks - count),
                                      std::rend(lanes.axes), false, &LaneWrist::Axis::locked);
  Eigen::Map<Eigen::Vector3d>(lanes.side) =
      Eigen::Map<const Eigen::Vector3d>(last->direction).unitOrthogonal();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const TurnWindow& window = windows[rule.reversed ? kJoints - 1 - i : i];
    lanes.windows[i] = {window.cosine_middle,
                        rule.reversed ? -window.sine_middle : window.sine_middle,
                        window.cosine_half};
  }
  lanes.slack = slack;
  return lanes;
}

}  // namespace

double ClosedForm::deviation() const noexcept {
  return planar_ ? planar_->deviation() : six_->deviation;
}

std::string ClosedForm::structure_name() const {
  const std::string nearly = exact() ? "" : "nearly ";
  if (planar_)
    return nearly + "planar arm";
  const SixJointRule& rule = six_->rule;
  if (rule.kind == SixJointRule::Kind::ThreeParallel) {
    const std::size_t first = rule.reversed ? 2 : 1;
    return nearly + "parallel axes " +
           joint_range(free_[first], free_[first + 1], free_[first + 2]);
  }
  return rule.reversed ? nearly + "spherical shoulder " + joint_range(free_[0], free_[1], free_[2])
                       : nearly + "spherical wrist " + joint_range(free_[3], free_[4], free_[5]);
}

void ClosedForm::append(const Eigen::Isometry3d& T_base_transfer, std::span<const double> locked,
                        Branches& branches) const {
  const Displacement T{T_base_transfer.linear(), T_base_transfer.translation() / scale_m_};
  if (planar_)
    append_planar(T, locked, branches);
  else
    append_six(T, locked, branches);
}

void ClosedForm::append_six(const Displacement& T, std::span<const double> locked,
                            Branches& branches) const {
  std::array<double, kMaxLocked> values{};
  for (std::size_t i = 0; i < locks_.size(); ++i)
    values[i] = prismatic_[i] ? locked[i] / scale_m_ : locked[i];
  SixJointTask task;
  task.wanted = T * T_transfer_base_;
  task.slack = slack_;
  std::copy(windows_.begin(), windows_.end(), task.windows.begin());
  lock(six_->axes, locks_, values.data(), task);
  const SixJointBranches found = solve_six_joints(task, six_->rule);
  branches.leave_out(found.outside);
  for (int b = 0; b < found.count; ++b) {
    double* q = branches.add();
    if (q == nullptr)
      return;
    for (std::size_t i = 0; i < kJoints; ++i)
      q[free_[i]] = found.angles[static_cast<std::size_t>(b)][i];
    for (std::size_t i = 0; i < locks_.size(); ++i)
      q[locks_[i]] = locked[i];
  }
}

void ClosedForm::append_lanes(const SimdKernels& kernels, const Eigen::Isometry3d& T_base_transfer,
                              const double (&locked)[kLaneLocks][kLanes], int most,
                              LaneWristBranches& branches) const {
  const bool reversed = six_->rule.reversed;
  const Displacement T{T_base_transfer.linear(), T_base_transfer.translation() / scale_m_};
  const Displacement along = T * T_transfer_base_;
  const Displacement D = reversed ? along.inverse() : along;
  double wanted[12];
  for (int i = 0; i < 12; ++i)
    wanted[i] = i < 9 ? D.R(i / 3, i % 3) : D.p[i - 9];
  double values[kLaneLocks][kLanes];
  for (std::size_t k = 0; k < locks_.size(); ++k) {
    const double scale = (prismatic_[k] ? 1 / scale_m_ : 1) * (reversed ? -1 : 1);
    double* lanes = values[reversed ? locks_.size() - 1 - k : k];
    for (int lane = 0; lane < kLanes; ++lane)
      lanes[lane] = scale * locked[k][lane];
  }
  kernels.wrist(*lanes_, wanted, values, most, branches);
}

void ClosedForm::write(const LaneWristBranches& branches, int i,
                       const double (&locked)[kLaneLocks][kLanes], double* q) const {
  const bool reversed = six_->rule.reversed;
  for (std::size_t j = 0; j < kJoints; ++j)
    q[free_[j]] = reversed ? -branches.angles[kJoints - 1 - j][i] : branches.angles[j][i];
  for (std::size_t k = 0; k < locks_.size(); ++k)
    q[locks_[k]] = locked[k][branches.lane[i]];
}

void ClosedForm::append_planar(const Displacement& T, std::span<const double> locked,
                               Branches& branches) const {
  std::array<double, kMaxDof> values;
  for (std::size_t i = 0; i < locks_.size(); ++i)
    values[static_cast<std::size_t>(locks_[i])] = locked[i];
  const PlanarBranches found = planar_->solve({free_, windows_, values.data(), slack_}, T);
  branches.leave_out(found.outside);
  for (int b = 0; b < found.count; ++b) {
    double* q = branches.add();
    if (q == nullptr)
      return;
    for (std::size_t i = 0; i < locks_.size(); ++i)
      q[locks_[i]] = locked[i];
    for (std::size_t i = 0; i < free_.size(); ++i)
      q[free_[i]] = found.angles[static_cast<std::size_t>(b)][i];
  }
}

/// Puts forms together and tries them.
struct ClosedFormSearch {
  const kinematics::Chain& chain;
  AxisChain axes = axes_of(chain);

  ClosedForm form(std::vector<int> locks, double deviation) const {
    ClosedForm result;
    result.locks_ = std::move(locks);
    result.free_ = others(static_cast<int>(chain.dof()), result.locks_);
    for (const int joint : result.locks_)
      result.prismatic_.push_back(axes.axes[static_cast<std::size_t>(joint)].prismatic);
    for (const int joint : result.free_)
      result.windows_.push_back(window(joint, deviation));
    result.T_transfer_base_ = axes.T_base_transfer.inverse();
    result.scale_m_ = axes.scale_m;
    result.slack_ = std::max(kSmallestSlack, kSlackPerDeviation * deviation);
    return result;
  }

  TurnWindow window(int index, double deviation) const {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(index)];
    if (joint.type != kinematics::JointType::Revolute)
      return {};
    const double margin =
        deviation > kExactStructure ? ClosedForm::kNearMargin_rad : ClosedForm::kExactMargin_rad;
    return TurnWindow::around(0.5 * (joint.lower + joint.upper),
                              0.5 * (joint.upper - joint.lower) + margin);
  }

  std::vector<ClosedForm> candidates() const {
    std::vector<ClosedForm> result;
    const int dof = static_cast<int>(chain.dof());
    if (const auto planar = PlanarForm::of(axes, chain)) {
      for (const std::vector<int>& free : planar_choices(dof, planar->free_joints())) {
        result.push_back(form(others(dof, free), planar->deviation()));
        result.back().planar_ = planar;
      }
      return result;
    }
    if (!chain.task_axes().all())
      return result;
    for (SixJointStructure& six : six_joint_structures(axes)) {
      result.push_back(form(six.locks, six.exact() ? 0 : six.deviation));
      result.back().lanes_ = lane_wrist(six, result.back().windows_, result.back().slack_);
      result.back().six_ = std::move(six);
    }
    return result;
  }

  /// Whether the form gives the configurations back that poses came from, at the values that their
  /// locked joints had: no reasoning about structures knows every way in which one can be of no
  /// use.
  bool recovers(const ClosedForm& form, const Samples& samples) const {
    const double tolerance = form.exact() ? kRecovered_rad : kNearlyRecovered_rad;
    int recovered = 0;
    Branches branches;
    for (std::size_t i = 0; i < samples.poses.size(); ++i) {
      const Configuration& q = samples.configurations[i];
      std::array<double, kMaxDof> locked;
      for (std::size_t k = 0; k < form.locks_.size(); ++k)
        locked[k] = q[form.locks_[k]];
      branches.clear();
      form.append(samples.poses[i], {locked.data(), form.locks_.size()}, branches);
      bool found = false;
      for (int b = 0; b < branches.size(); ++b)
        found = found || largest_difference(chain, branches[b], q) < tolerance;
      recovered += found ? 1 : 0;
    }
    return recovered >= (form.exact() ? kRecoveredShare : kNearlyRecoveredShare) * kTrials;
  }

  /// Configurations within limits per pose, at random values of the locked joints.
  double mean_within_limits(const ClosedForm& form, const Samples& samples) const {
    CounterGenerator generator(kSeed + 1);
    int within = 0;
    Branches branches;
    Configuration q(chain.dof());
    const JointSpace space(chain);
    for (const Eigen::Isometry3d& T : samples.poses) {
      const Configuration random = random_configuration(chain, generator);
      std::array<double, kMaxDof> locked;
      for (std::size_t k = 0; k < form.locks_.size(); ++k)
        locked[k] = random[form.locks_[k]];
      branches.clear();
      form.append(T, {locked.data(), form.locks_.size()}, branches);
      for (int b = 0; b < branches.size(); ++b) {
        std::copy_n(branches[b], q.size(), q.data());
        within += space.normalize(q.data()) ? 1 : 0;
      }
    }
    return static_cast<double>(within) / kTrials;
  }

  ClosedFormFinding run() const {
    ClosedFormFinding finding;
    std::vector<ClosedForm> forms = candidates();
    if (forms.empty())
      return finding;
    if (std::ranges::any_of(forms, &ClosedForm::exact))
      std::erase_if(forms, [](const ClosedForm& form) { return !form.exact(); });
    const Samples samples = sample(chain);
    ClosedForm* best = nullptr;
    for (ClosedForm& form : forms) {
      form.mean_within_limits_ = mean_within_limits(form, samples);
      if ((best == nullptr || form.mean_within_limits_ > kBetter * best->mean_within_limits_) &&
          recovers(form, samples))
        best = &form;
    }
    if (best == nullptr)
      return finding;
    const bool pays = best->locks_.empty() || best->mean_within_limits_ >= ClosedForm::kWorthwhile;
    (pays ? finding.form : finding.left_out) = std::move(*best);
    return finding;
  }
};

ClosedFormFinding find_closed_form(const kinematics::Chain& chain) {
  return ClosedFormSearch{chain}.run();
}

}  // namespace kinship::inverse
