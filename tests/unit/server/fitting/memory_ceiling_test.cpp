// What a fit takes of memory stays below a ceiling, whatever a legal profile asks for.

#include "server/fitting/memory_ceiling.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/profile_text.hpp"
#include "proto/types/stopped.hpp"
#include "server/fitting/fit_need.hpp"
#include "tests/unit/server/fitting/fit_fixture.hpp"

namespace kinship::fitting::memory_ceiling_test {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20U;

TEST(MemoryCeiling, WhoReservesWaitsUntilThereIsRoom) {
  MemoryCeiling ceiling(100);
  auto first = std::make_unique<MemoryCeiling::Reservation>(ceiling.reserve(60, {}));
  MemoryCeiling::Reservation small = ceiling.reserve(40, {});
  EXPECT_EQ(ceiling.reserved(), 100U);
  std::thread other([&] {
    const MemoryCeiling::Reservation second = ceiling.reserve(50, {});
    EXPECT_EQ(ceiling.reserved(), 90U);
  });
  first.reset();
  other.join();
  EXPECT_EQ(ceiling.reserved(), 40U);
  MemoryCeiling::Reservation moved;
  moved = std::move(small);
  EXPECT_EQ(ceiling.reserved(), 40U);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(static_cast<void>(ceiling.reserve(61, stop.get_token())), Stopped);
  EXPECT_THROW(static_cast<void>(ceiling.reserve(101, {})), std::invalid_argument);
}

/// A legal profile and whether its fit may be made below the ceiling.
struct Corner {
  const char* profile;
  bool fits;
};

constexpr std::size_t kCeiling_mb = 128;
constexpr int kPaths = 40;

constexpr Corner kCorners[] = {
    {"default", true},
    {"paper", true},
    {"default,components=1000", true},
    {"default,components=0,prior=auto", true},
    {"default,estimator=kde", true},
    {"default,max_solutions=100,min_distance=0,max_poses_per_path=16", true},
    {"default,tracks=100,track_candidates=100,least_coverage=0,max_poses_per_path=8", true},
    {"default,pose_spacing=0.01,max_poses_per_path=4096,max_solutions=1,tracks=0", true},
    {"default,pose_spacing=10,max_poses_per_path=1", true},
    {"default,pose_spacing=0.01,max_poses_per_path=0,max_solutions=100,min_distance=0", false},
    {"default,pose_spacing=0.01,max_poses_per_path=4096,max_solutions=100", false},
    {"default,pose_spacing=0.01,max_poses_per_path=0,tracks=100,track_candidates=100", false},
    {"paper,pose_spacing=0.01,max_solutions=100,min_distance=0,dropped_end_share=0", false},
};

class MemoryCorners : public FitDistribution, public testing::WithParamInterface<Corner> {
 protected:
  /// Long ones, to and fro within the limits: about 40 rad.
  static std::vector<Attempt> long_paths(const runtime::Robot& robot) {
    std::vector<Attempt> attempts = fleet::solved(robot, "shelf", kPaths, 1);
    for (int i = 0; i < kPaths; ++i) {
      Eigen::MatrixXd waypoints(3, 40);
      for (Eigen::Index w = 0; w < waypoints.cols(); ++w)
        waypoints.col(w) = Eigen::Vector3d(w % 2 == 0 ? -0.4 : 0.4, 0.6, 0.3) +
                           Eigen::Vector3d::Constant(0.005 * i);
      attempts[static_cast<std::size_t>(i)].path = Path(waypoints);
    }
    return attempts;
  }
  enum Outcome : int { Fitted, TooLarge, TooMuch, Else };

  /// In a process of its own: peaks of memory are a process's.
  [[noreturn]] void fit_and_exit(const DistributionKey& key);
};

std::size_t peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) / 1024;
}

void MemoryCorners::fit_and_exit(const DistributionKey& key) {
  const std::size_t before_mb = peak_mb();
  const std::unique_ptr<store::Store> store = store::open_sqlite_store(directory_ / "fleet.db");
  runtime::RobotRegistry robots(*store);
  std::string what;
  int outcome = Else;
  try {
    MemoryCeiling ceiling(kCeiling_mb * kMegabyte);
    const FitContext context{
        .store = *store, .robots = robots, .clock = clock_, .fit_threads = 2, .memory = &ceiling};
    outcome = fit_distribution(key, context, {}).distribution ? Fitted : Else;
  } catch (const Failure& failure) {
    what = failure.what();
    outcome = failure.code() == ErrorCode::TooLarge ? TooLarge : Else;
  }
  const std::size_t grown_mb = peak_mb() - before_mb;
  std::fprintf(stderr, "%s: %zu MB %s\n", GetParam().profile, grown_mb, what.c_str());
  constexpr std::size_t kBeside_mb = 32;  // the store, the robots, the libraries
  _exit(grown_mb > kCeiling_mb + kBeside_mb ? TooMuch : outcome);
}

TEST_P(MemoryCorners, StayBelowTheCeiling) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  report(long_paths(teacher_));
  DistributionKey key = key_of(pupil_);
  key.profile = profile_from_text(GetParam().profile).value_or_throw();
  store_.reset();  // before the fork: it has threads
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0)
    fit_and_exit(key);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), GetParam().fits ? Fitted : TooLarge);
}

INSTANTIATE_TEST_SUITE_P(Profiles, MemoryCorners, testing::ValuesIn(kCorners),
                         [](const auto& tested) { return std::to_string(tested.index); });

}  // namespace
}  // namespace kinship::fitting::memory_ceiling_test
