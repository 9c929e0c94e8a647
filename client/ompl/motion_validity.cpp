#include "client/ompl/motion_validity.hpp"

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <algorithm>
#include <utility>

#include "client/ompl/state_space.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;

}  // namespace

SeveralStatesValidity::SeveralStatesValidity(const ob::SpaceInformationPtr& information, One one,
                                             Ahead ahead, Between between)
    : ob::StateValidityChecker(information),
      one_(std::move(one)),
      ahead_(std::move(ahead)),
      between_(std::move(between)) {}

bool SeveralStatesValidity::are_valid(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
  for (Eigen::Index first = 0, together = planning::kFewTogether; first < qs.cols();
       first += std::exchange(together, planning::kTogether)) {
    const Eigen::Index count = std::min(together, qs.cols() - first);
    if (ahead_(qs.middleCols(first, count)) < count)
      return false;
  }
  return true;
}

StraightMotionValidator::StraightMotionValidator(const ob::SpaceInformationPtr& information)
    : ob::DiscreteMotionValidator(information) {}

bool StraightMotionValidator::checkMotion(const ob::State* from, const ob::State* to) const {
  const auto* several =
      dynamic_cast<const SeveralStatesValidity*>(si_->getStateValidityChecker().get());
  if (several == nullptr)
    return ob::DiscreteMotionValidator::checkMotion(from, to);
  const auto dof = static_cast<Eigen::Index>(si_->getStateDimension());
  Eigen::MatrixXd ends(dof, 2);
  ends << to_configuration(*from, dof), to_configuration(*to, dof);
  const bool is_valid = several->are_valid(asked(*from, *to)) && several->is_valid_between(ends);
  ++(is_valid ? valid_ : invalid_);
  return is_valid;
}

Eigen::MatrixXd StraightMotionValidator::asked(const ob::State& from, const ob::State& to) const {
  const auto* begin = from.as<ob::RealVectorStateSpace::StateType>()->values;
  const auto* end = to.as<ob::RealVectorStateSpace::StateType>()->values;
  const unsigned int dof = si_->getStateDimension();
  const int parts = static_cast<int>(si_->getStateSpace()->validSegmentCount(&from, &to));
  Eigen::MatrixXd qs(dof, std::max(parts, 1));
  const auto write = [&](Eigen::Index column, double share) {
    for (unsigned int i = 0; i < dof; ++i)
      qs(i, column) = begin[i] + (end[i] - begin[i]) * share;
  };
  std::copy(end, end + dof, qs.col(0).data());
  std::vector<std::pair<int, int>> halves;  // first and last of a range in between
  halves.reserve(static_cast<std::size_t>(qs.cols()));
  if (parts > 1)
    halves.emplace_back(1, parts - 1);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const auto [first, last] = halves[i];
    const int middle = (first + last) / 2;
    write(static_cast<Eigen::Index>(i) + 1, static_cast<double>(middle) / parts);
    if (first < middle)
      halves.emplace_back(first, middle - 1);
    if (last > middle)
      halves.emplace_back(middle + 1, last);
  }
  return qs;
}

}  // namespace kinship::ompl_planners
