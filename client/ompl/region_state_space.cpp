#include "client/ompl/region_state_space.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/ompl/motion_validity.hpp"

namespace kinship::ompl_planners {

namespace {

namespace ob = ompl::base;

ob::ConstrainedStateSpace::StateType& constrained(ob::State& state) {
  return *state.as<ob::ConstrainedStateSpace::StateType>();
}

}  // namespace

Eigen::VectorXd to_constrained_configuration(const ob::State& state) {
  return *state.as<ob::ConstrainedStateSpace::StateType>();
}

RegionStateSpace::RegionStateSpace(const ob::StateSpacePtr& ambient,
                                   planning::RegionConstraint& region, double step)
    : ob::ProjectedStateSpace(ambient,
                              std::make_shared<RegionOmplConstraint>(
                                  static_cast<Eigen::Index>(ambient->getDimension()), region)),
      region_(region),
      stepper_(step, region) {
  setDelta(step);
}

std::optional<Eigen::MatrixXd> RegionStateSpace::way(const Eigen::VectorXd& from,
                                                     const Eigen::VectorXd& to) const {
  if (std::lexicographical_compare(to.begin(), to.end(), from.begin(), from.end())) {
    auto back = way(to, from);
    if (back)
      *back = back->rowwise().reverse().eval();
    return back;
  }
  return stepper_.way(from, to);
}

bool RegionStateSpace::discreteGeodesic(const ob::State* from, const ob::State* to,
                                        bool interpolate, std::vector<ob::State*>* geodesic) const {
  if (geodesic)
    geodesic->assign(1, cloneState(from));
  Eigen::VectorXd q = to_constrained_configuration(*from), next(q.size());
  const Eigen::VectorXd target = to_constrained_configuration(*to);
  ob::State* reached = allocState();
  bool going = true;
  while (going && q != target) {
    if (stepper_.joins(q, target))
      next = target;
    else
      going = stepper_.advance(q, target, next);
    if (!going)
      break;
    constrained(*reached).copy(next);
    going = interpolate || si_->isValid(reached);
    if (going && geodesic)
      geodesic->push_back(cloneState(reached));
    q.swap(next);
  }
  freeState(reached);
  return going;
}

void RegionStateSpace::interpolate(const ob::State* from, const ob::State* to, double share,
                                   ob::State* state) const {
  std::vector<ob::State*> geodesic;
  discreteGeodesic(from, to, true, &geodesic);
  copyState(state, geodesicInterpolate(geodesic, share));
  for (ob::State* passed : geodesic)
    freeState(passed);
}

RegionMotionValidator::RegionMotionValidator(const ob::SpaceInformationPtr& information)
    : ob::MotionValidator(information),
      space_(*information->getStateSpace()->as<RegionStateSpace>()) {}

bool RegionMotionValidator::checkMotion(const ob::State* from, const ob::State* to) const {
  const Eigen::VectorXd begin = to_constrained_configuration(*from);
  const Eigen::VectorXd end = to_constrained_configuration(*to);
  if (!space_.holds(begin) || !space_.holds(end))
    return false;
  const auto way = space_.way(begin, end);
  if (!way)
    return false;
  if (const auto* several =
          dynamic_cast<const SeveralStatesValidity*>(si_->getStateValidityChecker().get()))
    return several->are_valid(way->rightCols(way->cols() - 1)) && several->is_valid_between(*way);
  ob::State* passed = space_.allocState();
  bool free = true;
  for (Eigen::Index i = 1; free && i < way->cols(); ++i) {
    constrained(*passed).copy(way->col(i));
    free = si_->isValid(passed);
  }
  space_.freeState(passed);
  return free;
}

bool RegionMotionValidator::checkMotion(const ob::State* from, const ob::State* to,
                                        std::pair<ob::State*, double>& last_valid) const {
  std::vector<ob::State*> geodesic;
  const bool arrived = space_.discreteGeodesic(from, to, false, &geodesic);
  const double whole = space_.distance(from, to);
  last_valid.second = whole > 0 ? space_.distance(from, geodesic.back()) / whole : 1;
  if (last_valid.first)
    space_.copyState(last_valid.first, geodesic.back());
  for (ob::State* passed : geodesic)
    space_.freeState(passed);
  return arrived;
}

namespace {

unsigned checked(Eigen::Index dof) {
  if (dof < 2)
    throw std::invalid_argument("RegionOmplConstraint: " + std::to_string(dof) +
                                " joints leave nothing free, need at least 2");
  return static_cast<unsigned>(dof);
}

}  // namespace

RegionOmplConstraint::RegionOmplConstraint(Eigen::Index dof, planning::RegionConstraint& region)
    : ompl::base::Constraint(checked(dof), 1, planning::RegionConstraint::kWaypointTolerance),
      region_(region) {}

void RegionOmplConstraint::function(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    Eigen::Ref<Eigen::VectorXd> out) const {
  out[0] = region_.distance(q);
}

void RegionOmplConstraint::jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    Eigen::Ref<Eigen::MatrixXd> out) const {
  const planning::RegionConstraint::Vector6 excess = region_.excess(q);
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

}  // namespace kinship::ompl_planners
