// The experience of a task on its way: two robots report paths to kinshipd, a third one fetches
// them as poses of the transfer frame in the task frame.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "client/link/client.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::task_experience_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class TaskExperiences : public testing::Test {
 protected:
  Digest register_model(const std::string& name) {
    const RegisterReply reply =
        client_.register_robot(test::model_description(name)).value_or_throw();
    EXPECT_NE(reply.status, RegisterStatus::Refused) << reply.message;
    return reply.robot;
  }

  /// Paths of a robot that stands somewhere in the task, straight between configurations.
  void report(const std::string& name, const Eigen::Isometry3d& T_task_base, int count,
              std::uint64_t seed) {
    const Digest robot = register_model(name);
    const kinematics::Chain chain = test::model_chain(name);
    std::mt19937_64 generator(seed);
    for (int i = 0; i < count; ++i) {
      Attempt attempt = test::panda_attempt(robot, "carry", 1);
      Eigen::MatrixXd waypoints(chain.dof(), 3);
      for (Eigen::Index column = 0; column < waypoints.cols(); ++column)
        waypoints.col(column) = test::random_configuration(chain, generator);
      attempt.path = Path(waypoints);
      attempt.T_task_base = T_task_base;
      client_.report(attempt);
      reported_.emplace(attempt.report_uuid, attempt);
    }
    ASSERT_EQ(client_.flush(seconds(60)).pending, 0U);
  }

  FetchReply fetch(const Digest& robot, std::uint64_t known = 0,
                   std::uint32_t bytes = kDefaultExperienceBytes) {
    FetchRequest request;
    request.task = "carry";
    request.robot = robot;
    request.deadline = milliseconds(0);
    request.experience_bytes = bytes;
    request.known_experience = known;
    return client_.fetch(request).value_or_throw();
  }

  /// Compares both ends of a path, and the middle of its length, with the forward kinematics of
  /// what was reported.
  void expect_reported(const PosePath& path, const kinematics::Chain& chain) const {
    const Attempt& attempt = reported_.at(path.path);
    EXPECT_EQ(path.source, attempt.robot);
    ASSERT_EQ(path.poses.size(), static_cast<std::size_t>(kExperiencePoses));
    const Eigen::MatrixXd& waypoints = attempt.path->waypoints();
    const auto expect_pose = [&](std::size_t index, const Eigen::VectorXd& q) {
      EXPECT_TRUE(path.poses[index].isApprox(
          *attempt.T_task_base * kinematics::T_base_transfer(chain, q), 1e-5))
          << "pose " << index;
    };
    expect_pose(0, waypoints.col(0));
    expect_pose(path.poses.size() - 1, waypoints.col(waypoints.cols() - 1));
    const double first = (waypoints.col(1) - waypoints.col(0)).norm();
    const double second = (waypoints.col(2) - waypoints.col(1)).norm();
    const double at = 13.0 / (kExperiencePoses - 1) * (first + second);
    expect_pose(
        13,
        at <= first
            ? Eigen::VectorXd(waypoints.col(0) + at / first * (waypoints.col(1) - waypoints.col(0)))
            : Eigen::VectorXd(waypoints.col(1) +
                              (at - first) / second * (waypoints.col(2) - waypoints.col(1))));
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  test::ServerProcess server_{
      {.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}}};
  link::Client client_{
      {.domain = domain_.number(), .outbox = directory_ / "outbox", .timeout = seconds(60)}};
  std::map<Uuid, Attempt> reported_;
};

TEST_F(TaskExperiences, OfTwoRobotsReachAThirdInTheTaskFrame) {
  const Eigen::Isometry3d turned =
      Eigen::Translation3d(0.3, -0.2, 0.8) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
  report("panda", Eigen::Isometry3d::Identity(), 6, 1);
  report("ur10e", turned, 5, 2);
  const Digest sawyer = register_model("sawyer");
  const FetchReply reply = fetch(sawyer);
  ASSERT_TRUE(reply.experience) << reply.message;
  EXPECT_EQ(reply.experience->paths_known, 11U);
  ASSERT_EQ(reply.experience->paths.size(), 11U);
  const std::map<Digest, kinematics::Chain> chains = {
      {register_model("panda"), test::model_chain("panda")},
      {register_model("ur10e"), test::model_chain("ur10e")}};
  for (const PosePath& path : reply.experience->paths)
    expect_reported(path, chains.at(path.source));
  EXPECT_EQ(reported_.size(), 11U);
}

TEST_F(TaskExperiences, AreSentOnceAndAgainWhenTheyChanged) {
  report("panda", Eigen::Isometry3d::Identity(), 6, 1);
  const Digest ur10e = register_model("ur10e");
  const FetchReply first = fetch(ur10e);
  ASSERT_TRUE(first.experience);
  EXPECT_FALSE(fetch(ur10e, first.experience->revision).experience);
  EXPECT_FALSE(fetch(register_model("panda"), first.experience->revision).experience)
      << "it is nobody's own";

  const Uuid gone = first.experience->paths[0].path;
  AdminRequest retire;
  retire.verb = AdminVerb::RetirePath;
  retire.argument = gone.text();
  EXPECT_EQ(client_.admin(retire).value_or_throw().status, AdminStatus::Ok);
  const FetchReply second = fetch(ur10e, first.experience->revision);
  ASSERT_TRUE(second.experience);
  EXPECT_EQ(second.experience->paths.size(), 5U);
  for (const PosePath& path : second.experience->paths)
    EXPECT_NE(path.path, gone);
}

TEST_F(TaskExperiences, ReachWhoWaitsForADistributionToo) {
  report("panda", Eigen::Isometry3d::Identity(), 6, 1);
  FetchRequest request;
  request.task = "carry";
  request.robot = register_model("panda");
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.deadline = seconds(120);
  request.experience_bytes = 4 * static_cast<std::uint32_t>(experience_bytes(kExperiencePoses));
  const FetchReply reply = client_.fetch(request).value_or_throw();
  EXPECT_TRUE(reply.distribution) << reply.message;
  ASSERT_TRUE(reply.experience);
  EXPECT_EQ(reply.experience->paths_known, 6U);
  EXPECT_EQ(reply.experience->paths.size(), 4U);
}

TEST_F(TaskExperiences, AreHeldByAFollowerAndFollowTheirTask) {
  report("panda", Eigen::Isometry3d::Identity(), 6, 1);
  FetchRequest request;
  request.task = "carry";
  request.robot = register_model("panda");
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.experience_bytes = kDefaultExperienceBytes;
  const auto follower = client_.follow(request);
  const auto deadline = std::chrono::steady_clock::now() + seconds(120);
  const auto first = follower->wait_for_newer(nullptr, deadline);
  ASSERT_TRUE(first) << follower->state().reason;
  const std::shared_ptr<const TaskExperience> held = follower->experience();
  ASSERT_TRUE(held);
  ASSERT_EQ(held->paths.size(), 6U);
  AdminRequest retire;
  retire.verb = AdminVerb::RetirePath;
  retire.argument = held->paths[2].path.text();
  EXPECT_EQ(client_.admin(retire).value_or_throw().status, AdminStatus::Ok);
  const auto second = follower->wait_for_newer(first, deadline);
  ASSERT_TRUE(second);
  EXPECT_GT(second->revision, first->revision);
  EXPECT_EQ(follower->experience()->paths.size(), 5U);
  EXPECT_NE(follower->experience()->revision, held->revision);
}

TEST_F(TaskExperiences, FillAMessageWithoutBreakingIt) {
  report("panda", Eigen::Isometry3d::Identity(), 900, 3);
  const FetchReply reply = fetch(register_model("ur10e"), 0, kMaxExperienceBytes);
  ASSERT_TRUE(reply.experience) << reply.message;
  EXPECT_EQ(reply.experience->paths_known, 900U);
  EXPECT_EQ(reply.experience->paths.size(),
            kMaxExperienceBytes / experience_bytes(kExperiencePoses));
}

}  // namespace
}  // namespace kinship::task_experience_test
