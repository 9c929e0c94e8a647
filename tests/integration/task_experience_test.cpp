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
