#include "client/ompl/region_ompl_constraint.hpp"

#include <stdexcept>
#include <string>

namespace kinship::planning {
namespace {

unsigned checked(Eigen::Index dof) {
  if (dof < 2)
    throw std::invalid_argument("RegionOmplConstraint: " + std::to_string(dof) +
                                " joints leave nothing free, need at least 2");
  return static_cast<unsigned>(dof);
}

}  // namespace

RegionOmplConstraint::RegionOmplConstraint(Eigen::Index dof, RegionConstraint& region)
    : ompl::base::Constraint(checked(dof), 1, RegionConstraint::kWaypointTolerance),
      region_(region) {}

void RegionOmplConstraint::function(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    Eigen::Ref<Eigen::VectorXd> out) const {
  out[0] = region_.distance(q);
}

void RegionOmplConstraint::jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    Eigen::Ref<Eigen::MatrixXd> out) const {
  const RegionConstraint::Vector6 excess = region_.excess(q);
  const double distance = excess.norm();
  if (distance == 0)
    out.setZero();
  else
    out = excess.transpose() * region_.derivative(q) / distance;
}

bool RegionOmplConstraint::project(Eigen::Ref<Eigen::VectorXd> q) const {
  Eigen::VectorXd projected = q;
  const bool arrived = region_.project(projected);
  q = projected;
  return arrived;
}

}  // namespace kinship::planning
