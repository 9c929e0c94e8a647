#pragma once

#include <ompl/base/Constraint.h>

#include <Eigen/Core>

#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {

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
  RegionOmplConstraint(Eigen::Index dof, RegionConstraint& region);

  /// Distance to the region, 1 m = 1 rad: 1.
  void function(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::VectorXd> out) const override;

  /// Its derivative, per joint unit; 0 within the region: 1 x dof.
  void jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::MatrixXd> out) const override;

  bool project(Eigen::Ref<Eigen::VectorXd> q) const override;

 private:
  RegionConstraint& region_;
};

}  // namespace kinship::planning
