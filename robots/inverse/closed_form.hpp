#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/types/limits.hpp"
#include "robots/inverse/axis.hpp"
#include "robots/inverse/lanes.hpp"
#include "robots/inverse/planar_form.hpp"
#include "robots/inverse/structure.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// Configurations that a closed form proposes for one pose, in storage of fixed size.
class Branches {
 public:
  static constexpr int kCapacity = 16;

  int size() const noexcept { return size_; }
  void clear() noexcept {
    size_ = 0;
    outside_limits_ = false;
  }
  /// The values of one configuration, dof of them, joint units.
  const double* operator[](int i) const { return values_[static_cast<std::size_t>(i)].data(); }

  /// Whether joint limits cut off branches: without limits there might be more.
  bool outside_limits() const noexcept { return outside_limits_; }
  void leave_out(bool any) noexcept { outside_limits_ = outside_limits_ || any; }

  /// Room for one more; nullptr if there is none.
  double* add() {
    return size_ < kCapacity ? values_[static_cast<std::size_t>(size_++)].data() : nullptr;
  }

 private:
  std::array<std::array<double, kMaxDof>, kCapacity> values_;
  int size_ = 0;
  bool outside_limits_ = false;
};

/// Inverse kinematics of one chain in closed form. Built once per chain; immutable, may be shared
/// by threads; its calls take neither heap nor locks.
class ClosedForm {
 public:
  /// Fewest configurations within limits, on average over reachable poses and random values of the
  /// locked joints, for which the closed form pays.
  static constexpr double kWorthwhile = 0.5;

  static constexpr double kExactMargin_rad = 1e-5;
  static constexpr double kNearMargin_rad = 0.1;

  /// Joints whose values the caller chooses, ascending, 0 the first; empty: the pose fixes all.
  std::span<const int> locks() const noexcept { return locks_; }

  /// Largest number of configurations per pose and values of the locked joints.
  int branches() const noexcept { return planar_ ? 2 : kMaxBranches; }

  /// Whether the axes have the structure exactly. If not, `append` gives solutions of the nominal
  /// chain, off by about `deviation()`, which need a polish.
  bool exact() const noexcept { return deviation() <= kExactStructure; }
  double deviation() const noexcept;  ///< share of the arm's size, or rad

  /// Configurations within limits per reachable pose and random values of the locked joints, as
  /// measured when built.
  double mean_within_limits() const noexcept { return mean_within_limits_; }

  /// Its structure, e.g. "spherical wrist 5-6-7".
  std::string structure_name() const;

  /// Appends all branches whose turning joints are within limits but for a margin (kNearMargin_rad
  /// if the structure is not exact, else kExactMargin_rad): in no particular order, in any turn,
  /// not verified, and at the boundary of reach also ones that just miss the pose. Singular poses
  /// get representatives of their families, with 0 for a joint that could have any value.
  /// \param T_base_transfer  pose of the transfer frame in the base link, m.
  /// \param locked           one value per lock, joint units.
  void append(const Eigen::Isometry3d& T_base_transfer, std::span<const double> locked,
              Branches& branches) const;

  /// Whether `append_lanes` can do what `append` does, for many values of the locked joints.
  bool has_lanes() const noexcept { return lanes_.has_value(); }

  /// The same for eight values of each locked joint, side by side. Lanes that are marked as hard
  /// are left to `append`.
  /// \param locked  joint units, by lock and lane.
  /// \param most    ends with the lane that reaches so many branches.
  void append_lanes(const SimdKernels& kernels, const Eigen::Isometry3d& T_base_transfer,
                    const double (&locked)[kLaneLocks][kLanes], int most,
                    LaneWristBranches& branches) const;

  /// The values of one configuration from `append_lanes`, dof of them, joint units.
  void write(const LaneWristBranches& branches, int i, const double (&locked)[kLaneLocks][kLanes],
             double* q) const;

 private:
  friend struct ClosedFormSearch;
  ClosedForm() = default;

  void append_six(const Displacement& T, std::span<const double> locked, Branches& branches) const;
  void append_planar(const Displacement& T, std::span<const double> locked,
                     Branches& branches) const;

  std::vector<int> locks_, free_;
  std::optional<SixJointStructure> six_;
  std::optional<PlanarForm> planar_;
  std::vector<bool> prismatic_;      ///< per lock
  std::vector<TurnWindow> windows_;  ///< per free joint
  std::optional<LaneWrist> lanes_;   ///< of locked arms with a wrist or shoulder
  Displacement T_transfer_base_;     ///< with every joint at 0
  double scale_m_ = 1;
  double slack_ = 0;
  double mean_within_limits_ = 0;
};

/// The closed form of a chain, if any.
struct ClosedFormFinding {
  std::optional<ClosedForm> form;  ///< a closed form that pays
  /// A closed form that does not pay, for too few configurations within limits.
  std::optional<ClosedForm> left_out;
};

/// Tries the closed forms of a chain's structure on random poses (same chain, same answer).
ClosedFormFinding find_closed_form(const kinematics::Chain& chain);

/// Text on the solution of a chain's inverse kinematics, e.g. "spherical wrist 5-6-7; lock q3;
/// closed form, 8 branches per lock", and on task axes that the chain cannot serve.
std::string describe_structure(const kinematics::Chain& chain);

}  // namespace kinship::inverse
