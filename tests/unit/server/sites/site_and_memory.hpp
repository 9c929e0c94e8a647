#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::sites {

/// Two stores, as a site and the memory above it have them; the robot is registered at the site.
class SiteAndMemory : public testing::Test {
 protected:
  SiteAndMemory() { EXPECT_TRUE(site_->register_robot(panda_)); }

  Attempt solved(std::uint64_t number) const {
    return test::make_attempt(panda_.digest, "shelf", number);
  }
  static std::vector<Uuid> reports_of(const store::Store& store) {
    std::vector<Uuid> reports;
    for (const store::ArrivedReport& report : store.list_arrivals("", "", 10'000).rows)
      reports.push_back(report.report_uuid);
    return reports;
  }
  static std::size_t paths_of(const store::Store& store) { return store.status().paths; }

  const test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> site_ = store::open_sqlite_store(directory_ / "site.db");
  std::unique_ptr<store::Store> memory_ = store::open_sqlite_store(directory_ / "memory.db");
  const store::RobotRecord panda_ = test::make_robot("panda", 1);
};

}  // namespace kinship::sites
