// The loops of the planners allocate nothing once they are warm: only trees, which double their
// room, take memory, and FCL, which makes its objects anew for every pair it is asked about. A
// program of its own, since it puts itself in front of the C library's malloc, which Eigen and
// operator new both call.

#include <dlfcn.h>
#include <execinfo.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "robots/planning/birrt.hpp"
#include "tests/unit/robots/planning/carrying_problem.hpp"

namespace {

std::uint64_t allocations = 0;  // of a program with one thread, FCL's left out
bool is_looking = false;        // at who asks; that may allocate too

bool is_for_fcl() {
  std::array<void*, 8> callers{};
  const int count = backtrace(callers.data(), static_cast<int>(callers.size()));
  for (int i = 0; i < count; ++i) {
    Dl_info where{};
    if (dladdr(callers[static_cast<std::size_t>(i)], &where) != 0 && where.dli_fname != nullptr &&
        std::string_view(where.dli_fname).find("libfcl") != std::string_view::npos)
      return true;
  }
  return false;
}

void count_allocation() {
  if (is_looking)
    return;
  is_looking = true;
  if (!is_for_fcl())
    ++allocations;
  is_looking = false;
}

}  // namespace

extern "C" {

// NOLINTBEGIN(readability-identifier-naming): the C library's names
void* __libc_malloc(std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) {
  count_allocation();
  return __libc_malloc(size);
}
void* realloc(void* memory, std::size_t size) {
  count_allocation();
  return __libc_realloc(memory, size);
}
void* calloc(std::size_t count, std::size_t size) {
  count_allocation();
  return __libc_calloc(count, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_allocation();
  return __libc_memalign(alignment, size);
}

}  // extern "C"

namespace kinship::planning::allocations_test {
namespace {

using test_support::Carrying;
using test_support::make_carrying;

/// Else the tests below could not fail.
TEST(Allocations, AreCounted) {
  const std::uint64_t before = allocations;
  const std::vector<double> by_new(100);
  const Eigen::MatrixXd by_eigen = Eigen::MatrixXd::Zero(10, 10);
  void* const by_malloc = std::malloc(100);
  EXPECT_EQ(allocations, before + 3) << by_new.size() << by_eigen.size() << by_malloc;
  std::free(by_malloc);
}

constexpr std::uint64_t kMaxChecks = 20'000, kWarm = 2'000;

/// Asks others, and counts the questions between which, or in which, something was allocated.
class Watch {
 public:
  /// \param free  of a configuration.
  template <typename Free>
  IsFree watched(Free free) {
    const auto alike = [this, free](const Eigen::Ref<const Eigen::MatrixXd>& qs, bool wanted) {
      Eigen::Index count = 0;
      while (count < qs.cols() && free(qs.col(count)) == wanted)
        ++count;
      note(static_cast<std::uint64_t>(std::min(count + 1, qs.cols())));
      return count;
    };
    return {[free](const Eigen::VectorXd& q) { return free(q); },
            [alike](const Eigen::Ref<const Eigen::MatrixXd>& qs) { return alike(qs, true); },
            [alike](const Eigen::Ref<const Eigen::MatrixXd>& qs) { return alike(qs, false); }};
  }

  /// After so many checks. \return the allocations since the question before.
  void note(std::uint64_t checks) {
    checks_ += checks;
    if (checks_ > kWarm && allocations != seen_)
      ++disturbed_;
    seen_ = allocations;
    ++questions_;
  }

  std::uint64_t questions() const { return questions_; }
  std::uint64_t disturbed() const { return disturbed_; }

 private:
  std::uint64_t checks_ = 0, questions_ = 0, disturbed_ = 0, seen_ = 0;
};

BirrtOptions options() {
  BirrtOptions options;
  options.step = 0.1;
  options.overshoot = 1;
  options.max_checks = kMaxChecks;
  options.time_limit = std::chrono::minutes(5);  // checks end it, on any machine
  return options;
}

/// Neither tree leaves its ball: so they grow for ever, and never meet.
auto near_either(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals, double radius) {
  return [start, goals, radius](const auto& q) {
    return (q - start).norm() < radius ||
           (goals.colwise() - q).colwise().norm().minCoeff() < radius;
  };
}

/// With and without a constraint. \param radius  joint units, 0: nothing is free but start and
/// goal.
Watch watch(const Carrying& carrying, double radius, bool upright) {
  Watch watch;
  const Eigen::MatrixXd goal = carrying.goals.leftCols<1>();
  const IsFree is_free = watch.watched(near_either(carrying.start, goal, radius + 1e-12));
  const ConfigurationSampler sampler(carrying.bounds);
  std::mt19937_64 generator(1);
  RegionConstraint constraint = carrying.constraint();
  const PlanSummary summary =
      upright
          ? plan_cbirrt2(carrying.start, goal, {is_free, constraint}, sampler, options(), generator)
          : plan_birrt(carrying.start, goal, is_free, sampler, options(), generator);
  EXPECT_EQ(summary.collision_checks, kMaxChecks);
  return watch;
}

class Allocations : public testing::TestWithParam<bool> {};

TEST_P(Allocations, NoneWhereNothingGrows) {
  const auto carrying = make_carrying("panda", 0);
  ASSERT_TRUE(carrying);
  const Watch found = watch(*carrying, 0, GetParam());
  EXPECT_GT(found.questions(), 2000u);
  EXPECT_EQ(found.disturbed(), 0u);
}

TEST_P(Allocations, OnlyWhereATreeDoublesItsRoom) {
  const auto carrying = make_carrying("panda", 0);
  ASSERT_TRUE(carrying);
  const Watch found = watch(*carrying, 0.6, GetParam());
  EXPECT_GT(found.questions(), 2000u);
  // Nodes, parents and what is scanned of either tree double, up to 20 000 nodes from 128 on; what
  // stands in boxes is made anew for every 4096.
  EXPECT_LE(found.disturbed(), 2 * (3 * 8 + 5u));
}

INSTANTIATE_TEST_SUITE_P(StraightAndUpright, Allocations, testing::Bool());

TEST(Allocations, NoneInChecks) {
  auto carrying = make_carrying("panda", 0);
  ASSERT_TRUE(carrying);
  std::mt19937_64 generator(1);
  const ConfigurationSampler sampler(carrying->bounds);
  Eigen::MatrixXd qs(carrying->chain.dof(), kTogether);
  const IsFree is_free = free_in(carrying->world);
  std::uint64_t disturbed = 0, free = 0;
  for (int question = 0; question < 2000; ++question) {
    for (Eigen::Index i = 0; i < qs.cols(); ++i)
      qs.col(i) = sampler.sample(generator);
    const std::uint64_t before = allocations;
    free += static_cast<std::uint64_t>(is_free.ahead(qs));
    is_free.blocked_ahead(qs);
    disturbed += question >= 1000 && allocations != before ? 1 : 0;
  }
  EXPECT_GT(free, 1000u);
  EXPECT_EQ(disturbed, 0u);
}

}  // namespace
}  // namespace kinship::planning::allocations_test
