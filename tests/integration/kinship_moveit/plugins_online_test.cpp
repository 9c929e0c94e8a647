// The plugins beside a real kinshipd: what they report comes back as samples and whole paths.

#include <algorithm>
#include <numeric>

#include "tests/integration/kinship_moveit/pipeline.hpp"
#include "tests/support/server_process.hpp"

namespace kinship::kinship_moveit_test {
namespace {

constexpr std::uint32_t kEnough_ms = 120'000;

class KINSHIP_FIXTURE_ONLINE : public PluginCell {
 protected:
  KINSHIP_FIXTURE_ONLINE()
      : server_({.store = directory_ / "fleet.db", .domain = domain_.number()}), client_(client()) {
    request_.size = sizeof request_;
    request_.robot = &robot_;
    request_.task = "reach";
    request_.deadline_ms = kEnough_ms;
  }
  void TearDown() override { kinship_client_close(client_); }

  /// Plans the shelf's queries with Kinship's planner, which reports them.
  void gain_experience() {
    const auto planner = this->planner(node());
    std::size_t solved = 0;
    for (const PosedQuery& posed : cell_.queries(0, 30)) {
      MotionPlanResponse answer;
      ASSERT_TRUE(comes_true([&] {
        answer = solve(*planner, scene(posed), request(posed.goals));
        return trajectory_of(answer) != nullptr;
      }));
      ++solved;
    }
    kinship_distribution* fetched = nullptr;
    kinship_distribution_info info{};
    info.size = sizeof info;
    ASSERT_TRUE(comes_true([&] {
      kinship_distribution_free(fetched);
      return kinship_fetch(client_, &request_, &fetched) == KINSHIP_OK &&
             kinship_distribution_describe(fetched, &info) == KINSHIP_OK && info.paths > solved / 2;
    })) << kinship_error_text();
    kinship_distribution_free(fetched);
    kinship_recall* recall = nullptr;
    request_.with_recall = 1;
    ASSERT_TRUE(comes_true([&] {
      return kinship_fetch_recall(client_, &request_, &recall) == KINSHIP_OK;
    })) << kinship_error_text();
    kinship_recall_free(recall);
  }

  /// Until the robot has been registered, and paths have come.
  static bool for_a_while(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!condition())
      if (std::chrono::steady_clock::now() > end)
        return false;
    return true;
  }

  /// Sum of the variances of joints.
  static double spread(const std::vector<Eigen::VectorXd>& drawn) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(kDof), square = mean;
    for (const Eigen::VectorXd& q : drawn) {
      mean += q / static_cast<double>(drawn.size());
      square += q.cwiseAbs2() / static_cast<double>(drawn.size());
    }
    return (square - mean.cwiseAbs2()).sum();
  }
  static std::vector<Eigen::VectorXd> draw(constraint_samplers::ConstraintSampler& sampler,
                                           const moveit::core::RobotState& start) {
    std::vector<Eigen::VectorXd> drawn;
    moveit::core::RobotState state = start;
    for (int i = 0; i < 400; ++i) {
      EXPECT_TRUE(sampler.sample(state, start));
      drawn.push_back(state.q);
    }
    return drawn;
  }
  double uniform_spread(moveit::core::RobotState state) const {
    std::vector<Eigen::VectorXd> drawn;
    for (int i = 0; i < 400; ++i) {
      state.setToRandomPositions(model_->getJointModelGroup("panda_arm"));
      drawn.push_back(state.q);
    }
    return spread(drawn);
  }

  const test::ServerProcess server_;
  kinship_client* client_;
  kinship_request request_{};
};

TEST_F(KINSHIP_FIXTURE_ONLINE, GiveSamplesOfTheFleetsExperience) {
  ASSERT_NO_FATAL_FAILURE(gain_experience());
  auto guided = node();
  guided->set("kinship.share", 1.0);
  guided->set("kinship.offer_recall", false);
  guided->set("kinship.first_wait_ms", 1000);
  guided->set("kinship.task", std::string("another"));
  Pipeline pipeline(*this, guided);
  const auto allocator = load<constraint_samplers::ConstraintSamplerAllocator>(
      "constraint_samplers::ConstraintSamplerAllocator", "kinship_moveit/SamplerAllocator");
  const PosedQuery posed = cell_.queries(100, 4).front();
  const auto scene = this->scene(posed);
  MotionPlanRequest asked = request(posed.goals);
  asked.planner_id = "RRTConnect@reach";
  moveit_msgs::msg::Constraints anywhere, first_joint, pose, seen;
  first_joint.joint_constraints.push_back({"panda_joint1", 0.15, 0.05, 0.05});
  pose.position_constraints.emplace_back();
  seen.visibility_constraints.emplace_back();
  const double uniform = uniform_spread(scene->state);
  bool was_guided = false;
  const auto search = [&](const MotionPlanRequest& plain, MotionPlanResponse&) {
    EXPECT_EQ(plain.planner_id, "RRTConnect");
    if (!allocator->canService(scene, "panda_arm", anywhere))
      return;
    was_guided = true;
    EXPECT_FALSE(allocator->canService(scene, "panda_arm", seen));
    EXPECT_FALSE(allocator->canService(scene, "hand", anywhere));
    EXPECT_LT(spread(draw(*allocator->alloc(scene, "panda_arm", anywhere), scene->state)),
              0.5 * uniform);
    EXPECT_LT(spread(draw(*allocator->alloc(scene, "panda_arm", pose), scene->state)),
              0.5 * uniform);
    const auto drawn = draw(*allocator->alloc(scene, "panda_arm", first_joint), scene->state);
    EXPECT_LT(spread(drawn), 0.5 * uniform);
    for (const Eigen::VectorXd& q : drawn) {
      EXPECT_GE(q[0], 0.1 - 1e-12);
      EXPECT_LE(q[0], 0.2 + 1e-12);
    }
  };
  EXPECT_TRUE(comes_true([&] {
    pipeline.plan(scene, asked, search);
    return was_guided;
  }));

  // A task that nobody did is planned as without Kinship.
  asked.planner_id = "RRTConnect";
  bool was_asked = false;
  pipeline.plan(scene, asked, [&](const MotionPlanRequest&, MotionPlanResponse&) {
    was_asked = true;
    EXPECT_FALSE(allocator->canService(scene, "panda_arm", anywhere));
  });
  EXPECT_TRUE(was_asked);
}

TEST_F(KINSHIP_FIXTURE_ONLINE, OfferStoredPathsUnlessTheSceneRefusesThem) {
  ASSERT_NO_FATAL_FAILURE(gain_experience());
  auto with_other = node();
  with_other->set("kinship.planner_plugin", std::string("other/Straight"));
  with_other->set("kinship.first_wait_ms", 1000);
  auto planner = this->planner(with_other);
  EXPECT_EQ(planner->getDescription(), "Kinship, then straight");
  const std::vector<PosedQuery> queries = cell_.queries(100, 12);
  std::size_t offered = 0;
  PosedQuery known;
  const auto offer = [&] {
    for (const PosedQuery& posed : queries) {
      const auto scene = this->scene(posed);
      auto answer = solve(*planner, scene, request(posed.goals));
      EXPECT_EQ(error_code_of(answer), moveit_msgs::msg::MoveItErrorCodes::SUCCESS);
      if (trajectory_of(answer)->getWayPointCount() == 2)
        continue;  // the other planner's
      ++offered;
      known = posed;
      EXPECT_TRUE(scene->isPathValid(*trajectory_of(answer), {},
                                     request(posed.goals).goal_constraints, "panda_arm"));
    }
    return offered > 0;
  };
  // Anew each time, without what it saw fail: a plan is cheap here, a few failures make paths not
  // worth their checks.
  const auto offer_all = [&] {
    planner.reset();
    planner = this->planner(with_other);
    return for_a_while(offer);
  };
  ASSERT_TRUE(comes_true(offer_all));

  // The same query in a scene where only its ends are free.
  const auto blocked = scene(known);
  blocked->is_valid = [&](const moveit::core::RobotState& state) {
    for (const auto& goal : known.goals.colwise())
      if (state.q.isApprox(goal, 1e-9))
        return true;
    return state.q.isApprox(known.start, 1e-9);
  };
  auto answer = solve(*planner, blocked, request(known.goals));
  ASSERT_NE(trajectory_of(answer), nullptr);
  EXPECT_EQ(trajectory_of(answer)->getWayPointCount(), 2U);

#ifdef KINSHIP_STUB_HUMBLE
  // The adapter offers it as well, before the planner is called.
  planner.reset();
  bool was_searched = true;
  EXPECT_TRUE(comes_true([&] {
    Pipeline pipeline(*this, with_other);
    return for_a_while([&] {
      for (const PosedQuery& posed : queries) {
        was_searched = false;
        answer = pipeline.plan(scene(posed), request(posed.goals),
                               [&](const auto&, MotionPlanResponse&) { was_searched = true; });
        if (!was_searched)
          return true;
      }
      return false;
    });
  }));
  EXPECT_GT(trajectory_of(answer)->getWayPointCount(), 2U);
#endif
}

}  // namespace
}  // namespace kinship::kinship_moveit_test
