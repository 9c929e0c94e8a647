// Recall in the C library: paths are tried with the caller's checker.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "client/c/handles.hpp"
#include "client/c/kinship.h"
#include "proto/types/pose.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/support/places.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

extern "C" int a_path_is_recalled_in_c(kinship_recall* recall, kinship_world* world,
                                       const kinship_recall_query* query, double* waypoints);

namespace kinship::c_recall_test {
namespace {

using recall::test_support::made_shelf;

constexpr size_t kDof = 7;

/// A scene as C has it, and a world with it.
class Scene {
 public:
  explicit Scene(const recall::PosedQuery& posed) {
    for (const SceneObject& object : posed.surroundings.scene.objects) {
      const Eigen::Vector3d size = std::get<BoxShape>(object.shape).size;
      kinship_object box{};
      box.size = sizeof box;
      box.name = object.name.c_str();
      std::ranges::copy(size, box.sizes);
      std::ranges::copy(to_pose_array(object.T_task_object), box.pose);
      objects.push_back(box);
    }
    const std::string folder = test::source_dir() + "/robots/models/panda";
    kinship_robot_file file{};
    file.size = sizeof file;
    file.source = folder.c_str();
    kinship_surroundings surroundings{};
    surroundings.size = sizeof surroundings;
    surroundings.objects = objects.data();
    surroundings.object_count = objects.size();
    EXPECT_EQ(kinship_world_create(&file, &surroundings, &world, nullptr), KINSHIP_OK)
        << kinship_error_text();
  }
  Scene(const Scene&) = delete;
  ~Scene() { kinship_world_free(world); }

  std::vector<kinship_object> objects;
  kinship_world* world = nullptr;
};

/// What the caller's checker is asked.
struct Checker {
  std::vector<Eigen::VectorXd> asked = {};
  kinship_world* world = nullptr;                      ///< null: only the start is free
  std::size_t most = std::numeric_limits<int>::max();  ///< gives up then

  static int is_free(void* user, const double* q, size_t dof) {
    auto& self = *static_cast<Checker*>(user);
    if (self.asked.size() == self.most)
      return -1;
    self.asked.emplace_back(Eigen::Map<const Eigen::VectorXd>(q, kDof));
    if (self.world == nullptr)
      return self.asked.back() == made_shelf().cell.start ? 1 : 0;
    int answer = 0;
    EXPECT_EQ(kinship_world_is_free(self.world, q, dof, &answer), KINSHIP_OK);
    return answer;
  }
};

class CRecall : public testing::Test {
 protected:
  CRecall() { recalled_.size = sizeof recalled_; }

  /// Tried as long as there is a candidate.
  static RecallLibrary patient() {
    RecallLibrary library = made_shelf().library;
    library.search_checks = 1e6;
    return library;
  }
  static kinship_recall_query asked(const recall::PosedQuery& posed, const Scene& scene,
                                    Checker& checker) {
    kinship_recall_query query{};
    query.size = sizeof query;
    query.dof = kDof;
    query.start = posed.start.data();
    query.goals = posed.goals.data();
    query.goal_count = static_cast<size_t>(posed.goals.cols());
    query.objects = scene.objects.data();
    query.object_count = scene.objects.size();
    query.is_free = Checker::is_free;
    query.user = &checker;
    return query;
  }
  kinship_code try_paths(const kinship_recall_query& query) {
    return kinship_recall_path(&recall_, &query, waypoints_.data(), KINSHIP_RECALL_WAYPOINTS,
                               &recalled_);
  }
  Eigen::MatrixXd path() const {
    return Eigen::Map<const Eigen::MatrixXd>(waypoints_.data(), kDof,
                                             static_cast<Eigen::Index>(recalled_.waypoint_count));
  }
  static void expect_refused(kinship_code code, const std::string& text) {
    EXPECT_EQ(code, KINSHIP_INVALID_INPUT);
    EXPECT_NE(std::string(kinship_error_text()).find(text), std::string::npos)
        << "no '" << text << "' in: " << kinship_error_text();
  }

  const std::vector<recall::PosedQuery> posed_ = made_shelf().cell.queries(100, 8);
  kinship_recall recall_{made_shelf().cell.chain, patient()};
  kinship_recalled recalled_{};
  std::array<double, kDof * KINSHIP_RECALL_WAYPOINTS> waypoints_{};
};

TEST_F(CRecall, APathWhoseLinesAreProvenInC) {
  int solved = 0;
  for (const recall::PosedQuery& posed : posed_) {
    const Scene scene(posed);
    Checker unused;
    const kinship_recall_query query = asked(posed, scene, unused);
    const int count = a_path_is_recalled_in_c(&recall_, scene.world, &query, waypoints_.data());
    ASSERT_GE(count, 0) << kinship_error_text();
    if (count == 0)
      continue;
    ++solved;
    kinship_proof proof{};
    proof.size = sizeof proof;
    ASSERT_EQ(kinship_world_path_free(scene.world, waypoints_.data(), static_cast<size_t>(count),
                                      kDof, KINSHIP_CLEARANCE_M, &proof),
              KINSHIP_OK)
        << kinship_error_text();
    EXPECT_EQ(proof.is_free, 1);
    const Eigen::Map<const Eigen::MatrixXd> path(waypoints_.data(), kDof, count);
    EXPECT_EQ(path.col(0), posed.start);
    EXPECT_EQ((posed.goals.colwise() - path.rightCols<1>().col(0)).colwise().norm().minCoeff(), 0);
  }
  EXPECT_GT(solved, 0);
}

TEST_F(CRecall, WithoutLinesConfigurationsAStepApartAreAsked) {
  int solved = 0;
  for (const recall::PosedQuery& posed : posed_) {
    const Scene scene(posed);
    Checker checker{.world = scene.world};
    kinship_recall_query query = asked(posed, scene, checker);
    query.step = 0.1;
    ASSERT_EQ(try_paths(query), KINSHIP_OK) << kinship_error_text();
    EXPECT_EQ(recalled_.checks, checker.asked.size());
    EXPECT_EQ(recalled_.size, sizeof recalled_);
    if (recalled_.is_recalled == 0) {
      EXPECT_EQ(recalled_.waypoint_count, 0U);
      continue;
    }
    ++solved;
    const Eigen::MatrixXd dense = planning::densified(path(), query.step);
    for (const auto& q : dense.colwise())
      EXPECT_TRUE(std::ranges::any_of(
          checker.asked, [&](const auto& known) { return (known - q).norm() < 1e-8; }));
  }
  EXPECT_GT(solved, 0);
}

TEST_F(CRecall, ALineThatTheCallerRefusesIsNotRecalled) {
  for (const recall::PosedQuery& posed : posed_) {
    const Scene scene(posed);
    Checker checker{.world = scene.world};
    kinship_recall_query query = asked(posed, scene, checker);
    query.is_line_free = [](void*, const double*, const double*, size_t) { return 0; };
    ASSERT_EQ(try_paths(query), KINSHIP_OK) << kinship_error_text();
    EXPECT_EQ(recalled_.is_recalled, 0);
    EXPECT_GT(recalled_.tries, 0U);
  }
}

TEST_F(CRecall, APoseIsReachedByAnyConfigurationWhereverTheBaseStands) {
  const kinematics::Chain& chain = made_shelf().cell.chain;
  const Eigen::Isometry3d moved(Eigen::Translation3d(2, -1, 0.1) *
                                Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()));
  for (const Eigen::Isometry3d& T_task_base : {Eigen::Isometry3d::Identity(), moved}) {
    const PoseArray base = to_pose_array(T_task_base);
    int solved = 0;
    for (const recall::PosedQuery& posed : posed_) {
      Scene scene(posed);
      for (std::size_t i = 0; i < scene.objects.size(); ++i)
        std::ranges::copy(
            to_pose_array(T_task_base * posed.surroundings.scene.objects[i].T_task_object),
            scene.objects[i].pose);
      Checker checker{.world = scene.world};
      kinship_recall_query query = asked(posed, scene, checker);
      const Eigen::Isometry3d T_base_goal = kinematics::T_base_transfer(chain, posed.goals.col(0));
      const PoseArray goal = to_pose_array(T_task_base * T_base_goal);
      query.T_task_base = base.data();
      query.goal_count = 0;
      query.T_task_goal = goal.data();
      ASSERT_EQ(try_paths(query), KINSHIP_OK) << kinship_error_text();
      if (recalled_.is_recalled == 0)
        continue;
      ++solved;
      EXPECT_TRUE(inverse::reaches(chain, T_base_goal, path().rightCols<1>()));
    }
    EXPECT_GT(solved, 0);
  }
}

TEST_F(CRecall, ACheckerMayGiveUpAndWhereNothingIsFreeNothingIsRecalled) {
  const Scene scene(posed_.front());
  Checker impatient{.world = scene.world, .most = 3};
  waypoints_.fill(77);
  ASSERT_EQ(try_paths(asked(posed_.front(), scene, impatient)), KINSHIP_OK);
  EXPECT_EQ(recalled_.is_recalled, 0);
  EXPECT_EQ(impatient.asked.size(), 3U);
  EXPECT_EQ(recalled_.checks, 4U) << "with the one that gave up";
  Checker blocked;
  ASSERT_EQ(try_paths(asked(posed_.front(), scene, blocked)), KINSHIP_OK);
  EXPECT_EQ(recalled_.is_recalled, 0);
  EXPECT_EQ(recalled_.waypoint_count, 0U);
  EXPECT_GT(recalled_.tries, 0U);
  EXPECT_TRUE(std::ranges::all_of(waypoints_, [](double number) { return number == 77; }));
}

TEST_F(CRecall, PathsThatDoNotHoldAreTrustedLess) {
  kinship_recall usual(made_shelf().cell.chain, made_shelf().library);
  const Scene scene(posed_.front());
  Checker blocked;
  const kinship_recall_query query = asked(posed_.front(), scene, blocked);
  std::vector<std::uint64_t> tries;
  for (int times = 0; times < 20; ++times) {
    ASSERT_EQ(kinship_recall_path(&usual, &query, waypoints_.data(), KINSHIP_RECALL_WAYPOINTS,
                                  &recalled_),
              KINSHIP_OK);
    tries.push_back(recalled_.tries);
  }
  EXPECT_LT(tries.back(), tries.front());
}

TEST_F(CRecall, WhatIsNoQueryIsRefusedWithNameValueAndLimit) {
  const Scene scene(posed_.front());
  Checker checker{.world = scene.world};
  const kinship_recall_query good = asked(posed_.front(), scene, checker);
  kinship_recall_query query = good;
  query.dof = 6;
  expect_refused(try_paths(query), "query->dof is 6, must be 7");
  query = good;
  query.is_free = nullptr;
  expect_refused(try_paths(query), "query->is_free is NULL");
  query = good;
  query.start = nullptr;
  expect_refused(try_paths(query), "query->start is NULL");
  query = good;
  Eigen::VectorXd far = posed_.front().start;
  far[3] = 1;
  query.start = far.data();
  expect_refused(try_paths(query), "query->start is beyond the limits");
  query = good;
  query.goals = far.data();
  query.goal_count = 1;
  expect_refused(try_paths(query), "all are beyond the limits");
  far[3] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(try_paths(query), "query->goals has a number that is not finite");
  query = good;
  query.goal_count = KINSHIP_RECALL_GOALS + 1;
  expect_refused(try_paths(query), "query->goal_count is 33, must be at most 32 (KINSHIP_RECALL_");
  query.goal_count = 0;
  expect_refused(try_paths(query), "query->T_task_goal is NULL");
  query = good;
  query.step = 2;
  expect_refused(try_paths(query), "query->step is 2, must be from ");
  expect_refused(kinship_recall_path(&recall_, &good, waypoints_.data(), 31, &recalled_),
                 "room is 31, must be at least 32");
  expect_refused(kinship_recall_path(nullptr, &good, waypoints_.data(), 32, &recalled_),
                 "recall is NULL");
  EXPECT_TRUE(checker.asked.empty());
  kinship_recall_free(nullptr);
}

}  // namespace
}  // namespace kinship::c_recall_test
