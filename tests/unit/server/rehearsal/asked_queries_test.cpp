#include "server/rehearsal/asked_queries.hpp"

#include <gtest/gtest.h>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/server/rehearsal/rehearsal_fixture.hpp"

namespace kinship::rehearsal {
namespace {

class AskedQueries : public RehearsalTest {
 protected:
  /// As a UR10e asks at the origin, where it can plan what the Panda did.
  std::vector<RecordedQuery> asked(const Eigen::Isometry3d& T_task_goal) {
    std::vector<RecordedQuery> queries = queries_for(ur10e_).queries;
    ask_in_recorded_scenes(T_task_goal, *robot(ur10e_), Eigen::Isometry3d::Identity(), {}, queries);
    return queries;
  }
  const Eigen::Isometry3d elsewhere_{Eigen::Translation3d(-0.6, 0.3, 0.5)};
};

TEST_F(AskedQueries, CopiesAskWhereNoRecordedGoalIsNear) {
  report_sweeps(12);
  const std::vector<RecordedQuery> recorded = queries_for(ur10e_).queries;
  const std::vector<RecordedQuery> queries = asked(elsewhere_);
  ASSERT_EQ(queries.size(), recorded.size() + 8);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const bool is_copy = i >= recorded.size();
    EXPECT_EQ(queries[i].T_task_goal.isApprox(elsewhere_), is_copy);
    EXPECT_FALSE(queries[i].T_task_drawn_base) << "all stood at one place";
  }
  EXPECT_EQ(asked(recorded.front().T_task_goal).size(), recorded.size()) << "that one is recorded";
}

TEST_F(AskedQueries, OwnOnesAreLeftAsTheyAre) {
  report_sweeps(3);
  std::vector<RecordedQuery> queries = queries_for(panda_).queries;
  ask_in_recorded_scenes(elsewhere_, *robot(panda_), Eigen::Isometry3d::Identity(), {}, queries);
  ASSERT_EQ(queries.size(), 3U);
  for (const RecordedQuery& query : queries)
    EXPECT_FALSE(query.T_task_goal.isApprox(elsewhere_));
}

TEST_F(AskedQueries, WhereRobotsMovePlacesAreDrawnAboutTodays) {
  const double turns[] = {-0.4, 0.1, 0.5};
  for (const double turn : turns) {
    const Eigen::Isometry3d T_task_base = Eigen::Translation3d(0.2 * turn, 0, 0.4) *
                                          Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
    report_sweeps(1, post(T_task_base), T_task_base);
  }
  std::vector<RecordedQuery> queries = queries_for(ur10e_).queries;
  const Eigen::Isometry3d far(Eigen::Translation3d(0, 5, 0));  // all recorded is out of reach
  ask_in_recorded_scenes(elsewhere_, *robot(ur10e_), far, {}, queries);
  ASSERT_EQ(queries.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(queries[i].T_task_drawn_base);
    const Eigen::Isometry3d& drawn = *queries[i].T_task_drawn_base;
    EXPECT_NEAR(drawn.translation().z(), 0, 1e-9) << "it stands as high as today";
    EXPECT_NEAR(drawn.translation().x(), 0.2 * (turns[i] - turns[1]), 1e-6);
    EXPECT_NEAR(std::atan2(drawn(1, 0), drawn(0, 0)), turns[i] - turns[1], 1e-6);
  }
  const auto posed =
      pose_query(*robot(ur10e_), Eigen::Isometry3d::Identity(), queries[0], {}, Branch::Usual);
  EXPECT_FALSE(posed) << "it stands five metres away";
}

}  // namespace
}  // namespace kinship::rehearsal
