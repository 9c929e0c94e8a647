#include "client/ompl/motion_validity.hpp"

#include <gtest/gtest.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <memory>
#include <random>
#include <vector>

#include "client/ompl/state_space.hpp"

namespace kinship::ompl_planners::motion_validity_test {
namespace {

namespace ob = ompl::base;

/// A space whose states are asked for one by one or together, and what was asked.
struct Space {
  Space(std::uint64_t seed, bool together) : allowed(static_cast<int>(seed % 40)) {
    Eigen::Matrix2Xd bounds(2, 3);
    bounds << -1, -1, -1, 1, 1, 1;
    information = std::make_shared<ob::SpaceInformation>(make_state_space(bounds));
    information->setStateValidityCheckingResolution(0.01);
    const auto is_free = [this](const Eigen::VectorXd& q) {
      asked.push_back(q);
      return static_cast<int>(asked.size()) <= allowed;
    };
    const auto one = [is_free](const ob::State& state) {
      return is_free(to_configuration(state, 3));
    };
    if (together)
      information->setMotionValidator(std::make_shared<StraightMotionValidator>(information));
    information->setStateValidityChecker(std::make_shared<SeveralStatesValidity>(
        information, one,
        [is_free](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
          Eigen::Index free = 0;
          while (free < qs.cols() && is_free(qs.col(free)))
            ++free;
          return free;
        },
        [](const Eigen::Ref<const Eigen::MatrixXd>&) { return true; }));
    information->setup();
  }

  bool check(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    ob::ScopedState<> a(information), b(information);
    copy_to_state(from, *a.get());
    copy_to_state(to, *b.get());
    asked.clear();
    return information->checkMotion(a.get(), b.get());
  }

  int allowed;
  ob::SpaceInformationPtr information;
  std::vector<Eigen::VectorXd> asked;
};

TEST(StraightMotionValidator, AsksForWhatOmplAsksForInItsOrder) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> joint(-1, 1);
  const auto anywhere = [&] {
    return Eigen::VectorXd::NullaryExpr(3, [&] { return joint(generator); }).eval();
  };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Space ompl(seed, false), ours(seed, true);
    const Eigen::VectorXd from = anywhere();
    const Eigen::VectorXd to = from + (anywhere() - from) * (static_cast<double>(seed % 7) / 6);
    EXPECT_EQ(ours.check(from, to), ompl.check(from, to)) << seed;
    EXPECT_EQ(ours.asked, ompl.asked) << seed;
    EXPECT_EQ(ours.information->getMotionValidator()->getValidMotionCount(),
              ompl.information->getMotionValidator()->getValidMotionCount());
    EXPECT_EQ(ours.information->getMotionValidator()->getInvalidMotionCount(),
              ompl.information->getMotionValidator()->getInvalidMotionCount());
  }
}

}  // namespace
}  // namespace kinship::ompl_planners::motion_validity_test
