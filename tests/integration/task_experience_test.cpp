// The experience of a task on its way from the robots that reported it to one that fetches or
// follows it.

#include <gtest/gtest.h>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::task_experience_test {
namespace {

using std::chrono::seconds;

class TaskExperiences : public testing::Test {
 protected:
  TaskExperiences() {
    cell_.start();
    panda_ = cell_.register_model("panda").robot;
    request_.task = "sweep";
    request_.robot = panda_;
    request_.experience_bytes = kDefaultExperienceBytes;
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
  Digest panda_;
  FetchRequest request_;
};

TEST_F(TaskExperiences, IsHeldByAFollowerAndFollowsItsTask) {
  const kinematics::Chain chain = test::model_chain("panda");
  cell_.report(panda_, 1, 6);
  const auto follower = cell_.client().follow(request_);
  const auto deadline = std::chrono::steady_clock::now() + seconds(120);
  const auto first = follower->wait_for_newer(nullptr, deadline);
  ASSERT_TRUE(first) << follower->state().reason;
  const std::shared_ptr<const TaskExperience> held = follower->experience();
  ASSERT_TRUE(held);
  ASSERT_EQ(held->paths.size(), 6U);
  for (const PosePath& path : held->paths) {
    ASSERT_EQ(path.poses.size(), static_cast<std::size_t>(kExperiencePoses));
    bool was_reported = false;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Eigen::MatrixXd waypoints = test::panda_sweep(seed).waypoints();
      was_reported |=
          path.poses.front().isApprox(kinematics::T_base_transfer(chain, waypoints.col(0)), 1e-5) &&
          path.poses.back().isApprox(kinematics::T_base_transfer(chain, waypoints.rightCols(1)),
                                     1e-5);
    }
    EXPECT_TRUE(was_reported);
  }
  ASSERT_EQ(cell_.ask(AdminVerb::RetirePath, held->paths[2].path.text()).status, AdminStatus::Ok);
  const auto second = follower->wait_for_newer(first, deadline);
  ASSERT_TRUE(second);
  EXPECT_GT(second->revision, first->revision);
  EXPECT_EQ(follower->experience()->paths.size(), 5U);
  EXPECT_NE(follower->experience()->revision, held->revision);
}

TEST_F(TaskExperiences, IsRehearsedOnceAlsoIfTheServerIsKilled) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Attempt attempt = test::panda_attempt(panda_, "sweep", seed);
    attempt.record.planner_options = "step=0.1 overshoot=1 max_checks=100000";
    attempt.scene.emplace().objects = {{"post", BoxShape{{0.08, 0.08, 1.2}},
                                        Eigen::Isometry3d(Eigen::Translation3d(0.62, 0, 0.6))}};
    cell_.client().report(attempt);
  }
  ASSERT_EQ(cell_.client().flush(test::Cell::kEnough).accepted, 6U);
  request_.rehearsed = true;
  request_.deadline = seconds(300);
  const FetchReply before = cell_.client().fetch(request_).value_or_throw();
  ASSERT_TRUE(before.rehearsal && before.rehearsal->is_complete) << before.message;
  ASSERT_TRUE(before.recall);
  cell_.kill();
  cell_.start();
  const FetchReply after = cell_.client().fetch(request_).value_or_throw();
  EXPECT_EQ(after.rehearsal, before.rehearsal);
  ASSERT_TRUE(after.recall);
  EXPECT_EQ(after.recall->revision, before.recall->revision);
  ASSERT_EQ(after.recall->paths.size(), before.recall->paths.size());
  for (std::size_t i = 0; i < after.recall->paths.size(); ++i)
    EXPECT_EQ(after.recall->paths[i].waypoints, before.recall->paths[i].waypoints);
  EXPECT_EQ(after.recall->solves, before.recall->solves);
  EXPECT_EQ(cell_.status().rehearsals, 0U) << "it was made by the server before";
  EXPECT_EQ(cell_.status().queued_rehearsals, 0U);
}

TEST_F(TaskExperiences, FillsAMessageWithoutBreakingIt) {
  cell_.report(panda_, 1, 900);
  request_.experience_bytes = kMaxExperienceBytes;
  request_.deadline = seconds(0);
  const FetchReply reply = cell_.client().fetch(request_).value_or_throw();
  ASSERT_TRUE(reply.experience) << reply.message;
  EXPECT_EQ(reply.experience->paths_known, 900U);
  EXPECT_EQ(reply.experience->paths.size(),
            kMaxExperienceBytes / experience_bytes(kExperiencePoses));
}

}  // namespace
}  // namespace kinship::task_experience_test
