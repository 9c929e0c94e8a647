#include "robots/planning/guided_sampler.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "robots/planning/planning_bounds.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::planning {
namespace {

/// A query of a planar arm, a mixture about its middle and one stored way.
class GuidedSamplers : public testing::Test {
 protected:
  GuidedSamplers() {
    TaskExperience stored;
    stored.revision = 1;
    stored.paths.push_back({{}, {}, {test::planar_pose(1, -0.5, 0), test::planar_pose(1, 0.5, 0)}});
    experience_ = std::make_shared<const ExperienceGuide>(chain_, stored);
  }

  GuidedSampler sampler(Guide guide, double guided_fraction = 1) const {
    return guided_sampler(chain_, query_, &mixture_, experience_,
                          {.guide = guide, .guided_fraction = guided_fraction});
  }

  const kinematics::Chain chain_ = test::PlanarArm{.lengths_m = {0.6, 0.5, 0.3}}.chain();
  const Eigen::Vector3d start_{-0.5, 0.3, 0.2};
  const Eigen::Vector3d goal_{0.5, 0.3, 0.2};
  const TrackQuery query_{Eigen::Isometry3d::Identity(), planning_bounds(chain_, start_), start_,
                          goal_};
  const Mixture mixture_{Eigen::VectorXd::Ones(1),
                         Eigen::MatrixXd::Zero(3, 1),
                         {Eigen::MatrixXd::Identity(3, 3) * 0.25}};
  std::shared_ptr<const ExperienceGuide> experience_;
};

TEST_F(GuidedSamplers, AGuideHasWhatItsNameSays) {
  for (int index = 0; index <= static_cast<int>(Guide::All); ++index) {
    const auto guide = static_cast<Guide>(index);
    const GuidedSampler guided = sampler(guide);
    EXPECT_EQ(guided.mixture_share > 0, has_mixture(guide)) << index;
    EXPECT_EQ(guided.track_share > 0, has_ways(guide) || has_retreat(guide)) << index;
    EXPECT_EQ(guided.sampler.tracks() != nullptr, guided.track_share > 0) << index;
    EXPECT_EQ(guided.sampler.guided_fraction(), guided.mixture_share + guided.track_share) << index;
    EXPECT_FALSE(guided.gate_fired);
  }
}

TEST_F(GuidedSamplers, WithoutExperienceTheMixtureHasAllSamples) {
  const GuidedSampler guided =
      guided_sampler(chain_, query_, &mixture_, nullptr, {.guide = Guide::All});
  EXPECT_EQ(guided.mixture_share, 1);
  EXPECT_EQ(guided.sampler.tracks(), nullptr);
}

TEST_F(GuidedSamplers, WithoutAMixtureTheTracksKeepTheirPart) {
  const GuidedSampler guided =
      guided_sampler(chain_, query_, nullptr, experience_, {.guide = Guide::All});
  EXPECT_EQ(guided.mixture_share, 0);
  EXPECT_EQ(guided.track_share, sampler(Guide::All).track_share);
}

TEST_F(GuidedSamplers, TheShareCutsBothParts) {
  const GuidedSampler all = sampler(Guide::All), half = sampler(Guide::All, 0.5);
  EXPECT_DOUBLE_EQ(half.mixture_share, all.mixture_share / 2);
  EXPECT_DOUBLE_EQ(half.track_share, all.track_share / 2);
  EXPECT_EQ(sampler(Guide::All, 0).sampler.guided_fraction(), 0);
}

TEST_F(GuidedSamplers, AMixtureFarFromTheQueryGetsLessTheFartherItIs) {
  const auto shifted = [&](double by) {
    const Mixture far{Eigen::VectorXd::Ones(1),
                      Eigen::MatrixXd::Constant(3, 1, by),
                      {Eigen::MatrixXd::Identity(3, 3) * 0.01}};
    return guided_sampler(chain_, query_, &far, experience_, {.guide = Guide::Mixture});
  };
  const GuidedSampler near = shifted(0), far = shifted(0.8), farthest = shifted(3);
  EXPECT_FALSE(near.gate_fired);
  EXPECT_TRUE(far.gate_fired);
  EXPECT_GT(far.mixture_share, 0);
  EXPECT_LT(far.mixture_share, near.mixture_share);
  EXPECT_TRUE(farthest.gate_fired);
  EXPECT_EQ(farthest.mixture_share, 0);
}

TEST_F(GuidedSamplers, TheRetreatComesFromEveryGoalUnlessWaysFollow) {
  const auto tracks_of = [&](Guide guide) {
    TrackQuery many = query_;
    many.goals = goal_.replicate(1, 6);
    for (Eigen::Index i = 0; i < many.goals.cols(); ++i)
      many.goals(0, i) += 0.05 * static_cast<double>(i);
    GuidedSampler guided = guided_sampler(chain_, many, nullptr, experience_, {.guide = guide});
    std::size_t count = 0;
    while (guided.sampler.tracks()->track(count) != nullptr)
      ++count;
    return count;
  };
  EXPECT_EQ(tracks_of(Guide::Retreat), 6U);
  EXPECT_EQ(tracks_of(Guide::Ways), 6U);
  EXPECT_EQ(tracks_of(Guide::RetreatWays), 9U);
}

}  // namespace
}  // namespace kinship::planning
