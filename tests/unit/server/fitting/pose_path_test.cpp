#include "server/fitting/pose_path.hpp"

#include <algorithm>
#include <limits>

#include "robots/kinematics/forward_kinematics.hpp"
#include "server/fitting/pose_path_memory.hpp"
#include "tests/unit/server/fitting/fit_fixture.hpp"

namespace kinship::fitting {
namespace {

class PosePaths : public FitDistribution {
 protected:
  std::vector<SharedPosePath> read(PosePathMemory& memory, const std::vector<Digest>& sources = {},
                                   std::int64_t since_ms = 0) {
    return memory.read("shelf", sources, since_ms, std::stop_token());
  }
  static std::vector<Uuid> uuids_of(const std::vector<SharedPosePath>& paths) {
    std::vector<Uuid> uuids;
    for (const SharedPosePath& path : paths)
      uuids.push_back(path->path);
    return uuids;
  }
  static std::vector<Uuid> uuids_of(const std::vector<Attempt>& attempts) {
    std::vector<Uuid> uuids;
    for (const Attempt& attempt : attempts)
      uuids.push_back(attempt.report_uuid);
    return uuids;
  }
};

store::StoredPath stored(const Path& path) {
  return {
      .id = 1, .report_uuid = Uuid::random(), .T_task_base = {}, .received_ms = 1, .path = path};
}

TEST_F(PosePaths, AreWhereTheTransferFrameWentInTheTask) {
  store::StoredPath path = stored(fleet::path(3, 1));
  path.T_task_base =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  const PosePath poses = pose_path(path, teacher_).value();
  EXPECT_EQ(poses.source, teacher_.digest);
  EXPECT_EQ(poses.path, path.report_uuid);
  ASSERT_EQ(poses.poses.size(), static_cast<std::size_t>(kExperiencePoses));
  const auto pose_of = [&](Eigen::Index column) {
    return *path.T_task_base *
           kinematics::T_base_transfer(teacher_.chain, path.path.waypoints().col(column));
  };
  EXPECT_TRUE(poses.poses.front().isApprox(pose_of(0), 1e-12));
  EXPECT_TRUE(poses.poses.back().isApprox(pose_of(path.path.size() - 1), 1e-12));
}

TEST_F(PosePaths, LieAtEqualPartsOfTheLengthOfJoints) {
  Eigen::MatrixXd waypoints = Eigen::MatrixXd::Zero(3, 3);
  waypoints(0, 1) = 0.3;  // of 1.3 rad
  waypoints(0, 2) = 1.3;
  const PosePath poses = pose_path(stored(Path(waypoints)), teacher_).value();
  for (int i = 0; i < kExperiencePoses; ++i) {
    const Eigen::AngleAxisd turn(poses.poses[static_cast<std::size_t>(i)].linear());
    EXPECT_NEAR(turn.angle(), 1.3 * i / (kExperiencePoses - 1), 1e-9);
  }
}

TEST_F(PosePaths, AreNotMadeOfWhatCannotBeOne) {
  EXPECT_FALSE(pose_path(stored(fleet::path(4, 1)), teacher_)) << "a path of another robot";
  EXPECT_FALSE(pose_path(stored(Path(Eigen::MatrixXd::Zero(3, 2))), teacher_)) << "no length";
  store::StoredPath far = stored(fleet::path(3, 1));
  far.T_task_base = Eigen::Translation3d(1000, 0, 0) * Eigen::Isometry3d::Identity();
  EXPECT_FALSE(pose_path(far, teacher_));
}

TEST_F(PosePaths, OfAllRobotsComeInTheOrderOfArrivalAndAreNotMadeAgain) {
  const std::vector<Attempt> attempts = {
      fleet::solved(teacher_, "shelf", 1), fleet::solved(pupil_, "shelf", 2),
      fleet::solved(teacher_, "shelf", 3), fleet::solved(pupil_, "other", 4)};
  report(attempts);
  PosePathMemory memory(*store_, registry_);
  std::vector<Uuid> expected = uuids_of(attempts);
  expected.pop_back();
  EXPECT_EQ(uuids_of(read(memory)), expected);
  EXPECT_EQ(memory.computed(), 3U);
  report({fleet::solved(pupil_, "shelf", 5)});
  EXPECT_EQ(read(memory).size(), 4U);
  EXPECT_EQ(memory.computed(), 4U);
  EXPECT_EQ(uuids_of(read(memory, {teacher_.digest})),
            (std::vector{attempts[0].report_uuid, attempts[2].report_uuid}));
  EXPECT_EQ(read(memory, {}, std::numeric_limits<std::int64_t>::max()).size(), 0U);
  EXPECT_EQ(memory.computed(), 4U);
}

TEST_F(PosePaths, ThatWereRetiredAreGone) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 3, 1);
  report(attempts);
  report({fleet::solved(pupil_, "shelf", 9)});
  PosePathMemory memory(*store_, registry_);
  EXPECT_EQ(read(memory).size(), 4U);
  ASSERT_TRUE(store_->retire_path(attempts[1].report_uuid));
  const std::vector<Uuid> left = uuids_of(read(memory));
  EXPECT_EQ(left.size(), 3U);
  EXPECT_EQ(std::count(left.begin(), left.end(), attempts[1].report_uuid), 0);
  EXPECT_EQ(memory.computed(), 6U) << "those of the teacher again, not that of the pupil";
  ASSERT_TRUE(store_->reset_task("shelf"));
  EXPECT_EQ(read(memory).size(), 0U);
}

TEST_F(PosePaths, ThatTheStoreDroppedAreGoneAndTheOthersAreNotMadeAgain) {
  constexpr std::uint64_t kCap = 6;
  const std::unique_ptr<store::Store> store =
      store::open_sqlite_store(directory_ / "capped.db", {.max_paths_per_pair = kCap});
  runtime::RobotRegistry registry(*store);
  registry.register_robot(fleet::teacher(), 1);
  const auto report_one = [&](std::uint64_t number) {
    std::promise<void> done;
    store->commit_reports({fleet::solved(teacher_, "shelf", number)},
                          [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  };
  PosePathMemory memory(*store, registry);
  for (std::uint64_t number = 1; number < 40; ++number) {
    report_one(number);
    std::vector<Uuid> kept;
    for (const store::StoredPath& path :
         store->read_paths(teacher_.digest, "shelf", {.after_id = 0, .limit = 100}))
      kept.push_back(path.report_uuid);
    EXPECT_EQ(uuids_of(read(memory)), kept);
  }
  EXPECT_EQ(memory.computed(), store->generation(teacher_.digest, "shelf")) << "each once";
  EXPECT_GT(memory.computed(), kCap);
}

TEST_F(PosePaths, AreTheNewestOfEachRobotIfThereAreTooMany) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 300, 1);
  report(attempts);
  const std::vector<Attempt> of_pupil = fleet::solved(pupil_, "shelf", 2, 1000);
  report(of_pupil);
  const auto last = [&](std::ptrdiff_t count) {
    return uuids_of(std::vector<Attempt>(attempts.end() - count, attempts.end()));
  };
  PosePathMemory memory(*store_, registry_, {.paths = 10});
  EXPECT_EQ(uuids_of(read(memory, {teacher_.digest})), last(8));
  EXPECT_EQ(read(memory).size(), 10U);
  EXPECT_EQ(memory.computed(), 10U);
  // As if it had begun now, whatever it knew.
  report(fleet::solved(pupil_, "shelf", 3, 2000));
  EXPECT_EQ(uuids_of(read(memory, {teacher_.digest})), last(5));
  for (const Attempt& attempt : of_pupil)
    ASSERT_TRUE(store_->retire_path(attempt.report_uuid));
  EXPECT_EQ(uuids_of(read(memory, {teacher_.digest})), last(7));
}

TEST_F(PosePaths, OfOtherTasksMakeRoom) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  report(fleet::solved(teacher_, "other", 6, 100));
  PosePathMemory small(*store_, registry_);
  read(small);
  EXPECT_GT(small.bytes(), 6 * kExperiencePoses * sizeof(Eigen::Isometry3d));
  const std::size_t most = small.bytes() * 3 / 2;
  PosePathMemory memory(*store_, registry_, {.bytes = most});
  read(memory);
  EXPECT_EQ(memory.read("other", {}, 0, std::stop_token()).size(), 6U);
  EXPECT_EQ(memory.computed(), 12U);
  EXPECT_EQ(memory.read("other", {}, 0, std::stop_token()).size(), 6U);
  EXPECT_EQ(memory.computed(), 12U);
  EXPECT_EQ(read(memory).size(), 6U);
  EXPECT_EQ(memory.computed(), 18U) << "it had to go";
  EXPECT_LE(memory.bytes(), most);
}

}  // namespace
}  // namespace kinship::fitting
