#pragma once

#include <ompl/base/Constraint.h>
#include <ompl/base/MotionValidator.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "robots/planning/region_constraint.hpp"

namespace kinship::ompl_planners {

/// Configurations along a task space region as a projected space of OMPL whose steps are those of
/// plan_cbirrt2, so that its motions have the guarantees of plan_cbirrt2: at most `step` apart,
/// within the tolerances of RegionConstraint at and between waypoints. (OMPL's own steps may be
/// twice as long, and are not checked in between.) Not shared between threads.
class RegionStateSpace : public ompl::base::ProjectedStateSpace {
 public:
  /// \param ambient  from make_state_space.
  /// \param region   borrowed: must outlive this; counts the projections.
  RegionStateSpace(const ompl::base::StateSpacePtr& ambient, planning::RegionConstraint& region,
                   double step);

  /// The configurations from one to another along the region, both included; equal in both
  /// directions. Not checked for collisions.
  /// \return dof x n, n >= 1; empty if the way gets stuck.
  std::optional<Eigen::MatrixXd> way(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;

  bool discreteGeodesic(const ompl::base::State* from, const ompl::base::State* to,
                        bool interpolate, std::vector<ompl::base::State*>* geodesic) const override;

  /// As far along the region as possible, if `to` cannot be reached.
  void interpolate(const ompl::base::State* from, const ompl::base::State* to, double share,
                   ompl::base::State* state) const override;

  bool holds(const Eigen::VectorXd& q) const { return region_.holds(q); }

 private:
  planning::RegionConstraint& region_;
  mutable planning::ConstrainedStepper stepper_;  // OMPL asks for ways by const methods
};

/// Whether the way between two states of a RegionStateSpace is free, the second state included.
/// (OMPL's own validator of constrained motions never checks the second state.)
class RegionMotionValidator : public ompl::base::MotionValidator {
 public:
  explicit RegionMotionValidator(const ompl::base::SpaceInformationPtr& information);

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to) const override;
  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to,
                   std::pair<ompl::base::State*, double>& last_valid) const override;

 private:
  const RegionStateSpace& space_;
};

/// \param state  of a constrained space.
Eigen::VectorXd to_constrained_configuration(const ompl::base::State& state);

/// A task space region as OMPL takes a constraint, for a ProjectedStateSpace: one equation, the
/// distance to the region, and the projection of RegionConstraint in place of OMPL's Newton steps.
/// Not for an AtlasStateSpace: a region is no manifold, and its inside has no tangent space.
///
/// Not shared between threads, and neither are spaces over it: projecting counts.
class RegionOmplConstraint : public ompl::base::Constraint {
 public:
  /// \param dof     at least 2.
  /// \param region  borrowed: must outlive this and the spaces over it.
  /// \throws std::invalid_argument if there are fewer joints.
  RegionOmplConstraint(Eigen::Index dof, planning::RegionConstraint& region);

  /// Distance to the region, 1 m = 1 rad: 1.
  void function(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::VectorXd> out) const override;

  /// Its derivative, per joint unit; 0 within the region: 1 x dof.
  void jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::MatrixXd> out) const override;

  bool project(Eigen::Ref<Eigen::VectorXd> q) const override;

 private:
  planning::RegionConstraint& region_;
};

}  // namespace kinship::ompl_planners
