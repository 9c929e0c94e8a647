// A kinshipd that keeps a few paths of each robot and task, killed in between: what it says of the
// others.

#include <gtest/gtest.h>

#include <set>

#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::retention_test {
namespace {

TEST(Retention, NoReceiptIsLostAndEveryCountSaysWhatIsKept) {
  const test::TemporaryDirectory folder;
  test::Cell cell({.folder = folder.path(), .arguments = {"--max-paths-per-pair", "6"}});
  cell.start();
  const Digest panda = cell.register_model("panda").robot;
  std::vector<Attempt> attempts;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    attempts.push_back(test::panda_attempt(panda, "sweep", seed));
    const Receipt receipt = cell.client().deliver({attempts.back()}).value_or_throw().at(0);
    const bool is_kept = receipt.status == ReceiptStatus::Stored;
    EXPECT_TRUE(is_kept || receipt.status == ReceiptStatus::Recorded);
    EXPECT_EQ(receipt.message.find("not kept") != std::string::npos, !is_kept) << receipt.message;
  }
  const auto exported = [&] {
    const test::Answer lines = cell.kinship("paths export --task sweep");
    std::set<Uuid> uuids;
    for (const Attempt& attempt : attempts)
      if (lines.says(attempt.report_uuid.text()))
        uuids.insert(attempt.report_uuid);
    return uuids;
  };
  const std::set<Uuid> kept = exported();
  EXPECT_EQ(kept.size(), 6U);
  cell.kill();
  cell.start();
  EXPECT_EQ(exported(), kept);
  for (const Receipt& receipt : cell.client().deliver(attempts).value_or_throw())
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate) << receipt.message;
  EXPECT_TRUE(cell.kinship("tasks list").says("6 of 30"));
  EXPECT_TRUE(cell.kinship("tasks show sweep").says("6 of 30 paths, 30 attempts"));
  EXPECT_TRUE(cell.kinship("paths list").says("dropped"));
  const test::Answer status = cell.kinship("status -o wide");
  for (const char* const part :
       {"6 paths (24 more were beyond the cap), 30 attempts",
        "6 of 6 paths, of the robot and task with most",
        " of 1024 MB of distributions in the store", " of 128 MB of distributions in memory"})
    EXPECT_TRUE(status.says(part)) << status.out;
}

}  // namespace
}  // namespace kinship::retention_test
