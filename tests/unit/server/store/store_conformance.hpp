#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/store/store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store {

/// What an engine is told to keep at most; 0: no limit.
struct EngineLimits {
  std::uint64_t paths_per_pair = 0;
  std::uint64_t distribution_bytes = 0;
  SearchLimits searches = {};
};

/// An engine under test: opens the store that lives in a directory, or makes it.
struct Engine {
  std::string name;
  std::function<std::unique_ptr<Store>(const std::filesystem::path& directory,
                                       const EngineLimits& limits)>
      open;
  /// What a backup has of the reports that come while it is made: those acknowledged before its
  /// copying ended, or those before it began.
  enum class BackupInstant { End, Begin } backup_instant = BackupInstant::End;
};

/// The laws of Store, for every engine. An engine's own test instantiates the suite:
/// INSTANTIATE_TEST_SUITE_P(Name, StoreConformance, testing::Values(engine)).
class StoreConformance : public testing::TestWithParam<Engine> {
 protected:
  StoreConformance() : store_(GetParam().open(directory_.path(), {})) {
    panda_ = test::make_robot("panda", 1);
    iiwa_ = test::make_robot("iiwa", 2);
    EXPECT_TRUE(store_->register_robot(panda_));
    EXPECT_TRUE(store_->register_robot(iiwa_));
  }

  void reopen(const EngineLimits& limits = {}) {
    store_.reset();
    store_ = GetParam().open(directory_.path(), limits);
  }
  /// Status of one reported attempt.
  ReceiptStatus report(const Attempt& attempt) {
    return test::report(*store_, {attempt}).at(0).status;
  }
  Attempt solved(std::uint64_t number) const {
    return test::make_attempt(panda_.digest, "shelf", number);
  }

  test::TemporaryDirectory directory_;
  std::unique_ptr<Store> store_;
  RobotRecord panda_;
  RobotRecord iiwa_;
};

/// The same for an engine that can copy its store into a file.
class StoreBackup : public StoreConformance {};

/// The same for a store with a cap of paths: what it keeps, and what it says of the others.
class StoreRetention : public StoreConformance {
 public:
  static constexpr std::uint64_t kCap = 8;
  static constexpr std::uint64_t kReports = 60;

 protected:
  StoreRetention() { reopen({.paths_per_pair = kCap}); }

  std::vector<Attempt> reports(std::uint64_t count = kReports) const {
    std::vector<Attempt> attempts;
    for (std::uint64_t number = 1; number <= count; ++number)
      attempts.push_back(solved(number));
    return attempts;
  }
  /// The reports whose paths are in use.
  std::set<Uuid> kept(const Store& store) const {
    std::set<Uuid> uuids;
    for (const StoredPath& path :
         store.read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 1000}))
      uuids.insert(path.report_uuid);
    return uuids;
  }
  std::set<Uuid> kept() const { return kept(*store_); }
  /// Reports until a path is kept, or is not.
  Receipt report_until(bool is_kept) {
    constexpr int kTries = 1000;
    for (int i = 0; i < kTries; ++i)
      if (const Receipt receipt = test::report(*store_, {solved(number_++)}).at(0);
          (receipt.status == ReceiptStatus::Stored) == is_kept)
        return receipt;
    throw std::runtime_error(is_kept ? "no path is kept" : "all paths are kept");
  }

  std::uint64_t number_ = kReports + 1;  ///< of the next report
};

class StoreRetentionBackup : public StoreRetention {};

/// Two stores of one engine, as a site and the memory above it are.
class StoreSharing : public StoreConformance {
 protected:
  static constexpr std::size_t kManyBytes = std::size_t{1} << 24U;

  StoreSharing() : other_(GetParam().open(other_directory_.path(), {})) {
    EXPECT_TRUE(other_->register_robot(panda_));
    EXPECT_TRUE(other_->register_robot(iiwa_));
  }
  ReplicatedReport shared(const Uuid& report) const {
    const std::vector<ReplicatedReport> read =
        store_->read_reports(std::vector{report}, kManyBytes).reports;
    if (read.size() != 1)
      throw std::runtime_error("no such report");
    return read[0];
  }
  bool is_listed_as_retired(const Store& store, const Uuid& report) const {
    const std::vector<Uuid> retired = store.list_retirements("", 1000).rows;
    return std::ranges::count(retired, report) == 1;
  }

  const test::TemporaryDirectory other_directory_;
  std::unique_ptr<Store> other_;
};

}  // namespace kinship::store
