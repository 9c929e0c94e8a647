#include "server/sites/compare.hpp"

#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

class Compare : public SiteAndMemory {};

TEST_F(Compare, NamesWhatDiffersByDigest) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  Attempt other = solved(9);
  other.report_uuid = solved(1).report_uuid;
  test::report(*memory_, {other, solved(2), solved(11), solved(12)});
  for (std::uint64_t number = 1; number <= 300; ++number)  // more than a page
    test::report(*site_, {solved(number == 11 || number == 12 ? number + 1000 : number)});
  std::set<Uuid> differing, missing;
  const Comparison found = compare(*site_, *memory_, [&](const Uuid& report, bool is_differing) {
    (is_differing ? differing : missing).insert(report);
  });
  EXPECT_EQ(found.same, 1U);
  EXPECT_EQ(found.of_memory_alone, 2U);
  EXPECT_EQ(found.differing, 1U);
  EXPECT_EQ(found.of_site_alone, 298U);
  EXPECT_EQ(differing, std::set<Uuid>{other.report_uuid});
  EXPECT_EQ(missing.size(), 298U);
  EXPECT_FALSE(missing.contains(solved(2).report_uuid));
}

}  // namespace
}  // namespace kinship::sites
