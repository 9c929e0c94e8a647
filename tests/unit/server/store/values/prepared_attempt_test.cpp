#include "server/store/values/prepared_attempt.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/store_values.hpp"

namespace kinship::store::prepared_attempt_test {
namespace {

constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();

TEST(PreparedAttempt, ACounterThatAColumnCannotHoldIsRefusedByItsName) {
  const Attempt attempt = test::make_attempt(test::id_from<Digest>(1), "shelf", 1);
  for (const auto& [name, counter] :
       {std::pair{"collision_checks", &PlanningRecord::collision_checks},
        std::pair{"projections", &PlanningRecord::projections},
        std::pair{"distribution_revision", &PlanningRecord::distribution_revision}}) {
    Attempt reported = attempt;
    reported.record.*counter = kLargest;
    EXPECT_TRUE(prepare(reported)) << name;
    reported.record.*counter = kLargest + 1;
    const Result<PreparedAttempt> refused = prepare(reported);
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
    EXPECT_EQ(refused.error().message, "attempt " + attempt.report_uuid.text() + ": " + name +
                                           " 9223372036854775808 exceeds 9223372036854775807");
  }
}

}  // namespace
}  // namespace kinship::store::prepared_attempt_test
