#include "server/sites/compare.hpp"

#include <map>

#include "server/store/sqlite/database/database.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

class Compare : public SiteAndMemory {
 protected:
  Comparison compare_stores(std::map<Difference, std::set<Uuid>>& told) const {
    const auto site = store::open_report_digests((directory_ / "site.db").string());
    const auto memory = store::open_report_digests((directory_ / "memory.db").string());
    return compare(*site, *memory, [&told](const Uuid& report, Difference difference) {
      told[difference].insert(report);
    });
  }
  /// Of a store that no server has open: another digest in the row of an attempt.
  void damage(const char* file, int id) const {
    store::Database(directory_ / file, store::Access::ReadWrite)
        .execute("UPDATE attempt SET body_sha256 = zeroblob(32) WHERE id = " + std::to_string(id));
  }
};

TEST_F(Compare, NamesWhatDiffersByDigest) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  Attempt other = solved(9);
  other.report_uuid = solved(1).report_uuid;
  test::report(*memory_, {other, solved(2), solved(11), solved(12)});
  for (std::uint64_t number = 1; number <= 300; ++number)  // more than a page
    test::report(*site_, {solved(number == 11 || number == 12 ? number + 1000 : number)});
  std::map<Difference, std::set<Uuid>> told;
  const Comparison found = compare_stores(told);
  EXPECT_EQ(found.same, 1U);
  EXPECT_EQ(found.of_memory_alone, 2U);
  EXPECT_EQ(found.differing, 1U);
  EXPECT_EQ(found.of_site_alone, 298U);
  EXPECT_EQ(found.damaged, 0U);
  EXPECT_EQ(told[Difference::TwoContents], std::set<Uuid>{other.report_uuid});
  EXPECT_EQ(told[Difference::NotInMemory].size(), 298U);
  EXPECT_FALSE(told[Difference::NotInMemory].contains(solved(2).report_uuid));
}

TEST_F(Compare, ADamagedRowIsNoSecondContent) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  for (store::Store* const store : {site_.get(), memory_.get()})
    test::report(*store, {solved(1), solved(2), solved(3)});
  memory_.reset();
  damage("memory.db", 2);
  site_.reset();
  damage("site.db", 3);
  std::map<Difference, std::set<Uuid>> told;
  const Comparison found = compare_stores(told);
  EXPECT_EQ(found.same, 1U);
  EXPECT_EQ(found.differing, 0U);
  EXPECT_EQ(found.damaged, 2U);
  EXPECT_EQ(told[Difference::DamagedInMemory], std::set<Uuid>{solved(2).report_uuid});
  EXPECT_EQ(told[Difference::DamagedAtSite], std::set<Uuid>{solved(3).report_uuid});
}

}  // namespace
}  // namespace kinship::sites
