#pragma once

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/StateValidityChecker.h>

#include <Eigen/Core>
#include <functional>
#include <vector>

/// Motions of OMPL whose states are checked together; for this library's sources only.
namespace kinship::ompl_planners {

/// A validity checker for several states at once.
class SeveralStatesValidity : public ompl::base::StateValidityChecker {
 public:
  using One = std::function<bool(const ompl::base::State& state)>;
  /// \param way  dof x n. \return whether the lines between its columns are valid.
  using Between = std::function<bool(const Eigen::Ref<const Eigen::MatrixXd>& way)>;
  /// \param qs  dof x n. \return the number of valid columns before the first invalid one; later
  ///            ones are not checked.
  using Ahead = std::function<Eigen::Index(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;

  SeveralStatesValidity(const ompl::base::SpaceInformationPtr& information, One one, Ahead ahead,
                        Between between);

  bool isValid(const ompl::base::State* state) const override { return one_(*state); }

  /// Whether all are valid; checks a few at a time. \param qs  dof x n.
  bool are_valid(const Eigen::Ref<const Eigen::MatrixXd>& qs) const;

  /// Whether the lines between a way's columns are valid, if lines are proven. \param way  dof x n
  bool is_valid_between(const Eigen::Ref<const Eigen::MatrixXd>& way) const {
    return between_(way);
  }

 private:
  const One one_;
  const Ahead ahead_;
  const Between between_;
};

/// OMPL's validator of straight motions in a space from make_state_space, in its order: the second
/// state, then the middle, then the middles of the halves, and so on. Checks the states together if
/// the checker of `information` is a SeveralStatesValidity, and then the proof of the motion if
/// lines are proven.
class StraightMotionValidator : public ompl::base::DiscreteMotionValidator {
 public:
  explicit StraightMotionValidator(const ompl::base::SpaceInformationPtr& information);

  using ompl::base::DiscreteMotionValidator::checkMotion;
  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to) const override;

 private:
  /// The states that OMPL checks, in its order: dof x n.
  Eigen::MatrixXd asked(const ompl::base::State& from, const ompl::base::State& to) const;
};

}  // namespace kinship::ompl_planners
