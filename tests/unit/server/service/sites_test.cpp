// A service as the server of a site: what goes to the memory above it, and what comes from it.

#include <thread>

#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service {
namespace {

class SitesTest : public ServiceFixture {
 protected:
  SitesTest() {
    adjust_ = [this](ServiceOptions& options) {
      options.upstream.name = "postgresql://memory/kinship";
      options.upstream.open = [this]() -> std::unique_ptr<store::Store> {
        if (is_cut_)
          throw Failure(ErrorCode::Unavailable, "no route to host");
        return std::make_unique<store::TroubledStore>(*memory_);
      };
    };
    start();
  }
  /// What another site reported.
  void report_elsewhere(const std::vector<Attempt>& attempts) {
    runtime::RobotRegistry(*memory_).register_robot(fleet::teacher(), 1);
    std::promise<void> done;
    memory_->commit_reports(attempts, [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  }
  template <typename Condition>
  static bool comes_true(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return condition();
  }
  UpstreamStatus upstream() const { return service_->status().upstream.value(); }

  const test::TemporaryDirectory memory_directory_;
  std::unique_ptr<store::Store> memory_ = store::open_sqlite_store(memory_directory_ / "memory.db");
  std::atomic<bool> is_cut_ = false;
};

TEST_F(SitesTest, WhoFetchesIsServedWithWhatOtherSitesDid) {
  report_elsewhere(fleet::solved(teacher_, "shelf", 6, 1));
  fetch(request_for(pupil_));  // it is wanted from now on, and may be here already
  ASSERT_TRUE(comes_true([&] { return upstream().received == 6; })) << log();
  const FetchReply reply = fetch(request_for(pupil_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources.at(0).paths, 6U);
  EXPECT_TRUE(is_told("6 paths of other sites came")) << log();
}

TEST_F(SitesTest, WhatIsRetiredAboveIsNotServedHere) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 6, 1);
  report(attempts);
  ASSERT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  ASSERT_TRUE(comes_true([&] { return memory_->status().paths == 6; }));
  ASSERT_TRUE(memory_->reset_task("shelf"));
  advance(std::chrono::seconds(60));
  report({fleet::unsolved(teacher_.digest, "other")});  // wakes who looks
  // The service is told of it once it is in the store.
  EXPECT_TRUE(comes_true([&] {
    return fetch(request_for(pupil_)).status == FetchStatus::NoExperience;
  })) << log();
  EXPECT_EQ(service_->status().paths, 0U);
}

TEST_F(SitesTest, WhatDoesNotFitItsRobotIsSetAside) {
  std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 1, 1);
  Attempt far = fleet::solved(teacher_, "shelf", 2);
  far.path = Path(Eigen::MatrixXd::Constant(3, 2, 9.0) + Eigen::MatrixXd::Identity(3, 2));
  attempts.push_back(far);
  report_elsewhere(attempts);
  fetch(request_for(pupil_));
  ASSERT_TRUE(comes_true([&] { return upstream().refused == 1; })) << log();
  EXPECT_EQ(upstream().received, 1U);
  EXPECT_NE(upstream().first_refused.find(far.report_uuid.text()), std::string::npos);
}

TEST_F(SitesTest, AServerWithoutAMemoryAboveSaysNothingOfIt) {
  adjust_ = {};
  start();
  EXPECT_FALSE(service_->status().upstream);
}

}  // namespace
}  // namespace kinship::service
