// Refits inside the service: what it keeps between them, and what it tells.

#include <gtest/gtest.h>

#include "server/catalog/freshness.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::warm_service_test {
namespace {

/// A service that remembers its fits.
class WarmService : public ServiceFixture {
 protected:
  WarmService() {
    adjust_ = [](ServiceOptions& options) { options.fit = {}; };
    start();
    request_ = request_for(pupil_);
    request_.profile = "default,components=4,pose_spacing=1";
  }

  void report_more(int paths) {
    report(fleet::solved(teacher_, "shelf", paths, next_seed_));
    next_seed_ += 1000;
    advance(catalog::kRefitInterval);
  }
  /// The one after a revision: fetched, and fetched again once its fit was told.
  Distribution after(std::uint64_t revision) {
    fetch(request_);
    EXPECT_TRUE(is_told(" revision " + std::to_string(revision + 1) + ": ")) << events();
    return fetch(request_).distribution.value();
  }

  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  const runtime::Robot pupil_ = fleet::robot_of(fleet::pupil());
  FetchRequest request_;
  std::uint64_t next_seed_ = 1;
};

TEST_F(WarmService, TellsWhichOfTheTwoHappened) {
  report_more(20);
  const Distribution first = fetch(request_).distribution.value();
  EXPECT_EQ(first.fit, (FitOrigin{0, 0, 20, 20, 20, "no earlier one in memory"}));
  report_more(5);
  const Distribution second = after(1);
  EXPECT_EQ(second.revision, 2U);
  EXPECT_EQ(second.fit, (FitOrigin{1, 1, 25, 5, 5, ""}));
  EXPECT_TRUE(is_told("incremental from revision 1, 5 of 25 paths new")) << events();
  EXPECT_NE(log().find("full (no earlier one in memory), 20 paths"), std::string::npos) << log();

  const AdminPage page =
      administer(fleet::question(AdminVerb::ExplainDistribution, second.id.hex()));
  const std::vector<AdminRow>& explanations = page.rows;
  ASSERT_EQ(explanations.size(), 1U) << page.message;
  EXPECT_EQ(std::get<Explanation>(explanations[0]).distribution.fit, second.fit);
}

TEST_F(WarmService, ARestartedOneBeginsAnew) {
  report_more(20);
  fetch(request_);
  start();
  EXPECT_EQ(fetch(request_).distribution->revision, 1U);  // served meanwhile, from the store
  report_more(5);
  const Distribution second = after(1);
  EXPECT_EQ(second.fit, (FitOrigin{0, 0, 25, 25, 25, "no earlier one in memory"}));
}

TEST_F(WarmService, AnEvictedOneBeginsAnew) {
  report_more(20);
  const Distribution first = fetch(request_).distribution.value();
  administer(fleet::question(AdminVerb::EvictDistribution, first.id.hex()));
  const Distribution second = fetch(request_).distribution.value();
  EXPECT_EQ(second.fit, (FitOrigin{0, 0, 20, 20, 20, "no earlier one in memory"}));
  EXPECT_EQ(second.mixture->means(), first.mixture->means());
}

TEST_F(WarmService, ARetirementIsAFullFitOfWhatIsLeft) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 20, 500);
  report(attempts);
  fetch(request_);
  administer(fleet::question(AdminVerb::RetirePath, attempts[0].report_uuid.text()));
  const Distribution second = fetch(request_).distribution.value();
  EXPECT_EQ(second.revision, 2U);
  EXPECT_EQ(second.fit, (FitOrigin{0, 0, 19, 19, 0, "1 paths of revision 1 left out or changed"}));
}

}  // namespace
}  // namespace kinship::service::warm_service_test
