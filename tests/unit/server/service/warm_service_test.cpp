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

  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  const runtime::Robot pupil_ = fleet::robot_of(fleet::pupil());
  FetchRequest request_;
  std::uint64_t next_seed_ = 1;
};

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
