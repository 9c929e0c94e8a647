#include "client/cli/audit_selection.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace kinship::cli::audit_selection_test {
namespace {

std::vector<std::int64_t> shown(AuditSelection selection, const std::vector<std::int64_t>& times) {
  std::vector<std::int64_t> taken;
  for (const std::int64_t time : times) {
    AuditEntry entry;
    entry.time_ms = time;
    if (selection.takes(entry))
      taken.push_back(time);
    if (selection.is_full())
      break;
  }
  return taken;
}

using Times = std::vector<std::int64_t>;

TEST(AuditSelection, AnOldEntryEndsNothing) {
  // The clock was set back between the second and the third.
  const Times newest_first = {500, 100, 450, 90};
  EXPECT_EQ(shown({400, 0}, newest_first), (Times{500, 450}));
  EXPECT_EQ(shown({0, 0}, newest_first), newest_first);
}

TEST(AuditSelection, TheLimitIsOfWhatIsShown) {
  EXPECT_EQ(shown({400, 2}, {500, 100, 450, 440}), (Times{500, 450}));
  EXPECT_EQ(shown({0, 3}, {500, 100, 450, 440}), (Times{500, 100, 450}));
}

}  // namespace
}  // namespace kinship::cli::audit_selection_test
