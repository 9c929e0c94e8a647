#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "server/store/store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store {

/// An engine under test: opens the store that lives in a directory, or makes it.
struct Engine {
  std::string name;
  std::function<std::unique_ptr<Store>(const std::filesystem::path& directory)> open;
};

/// The laws of Store, for every engine. An engine's own test instantiates the suite:
/// INSTANTIATE_TEST_SUITE_P(Name, StoreConformance, testing::Values(engine)).
class StoreConformance : public testing::TestWithParam<Engine> {
 protected:
  StoreConformance() : store_(GetParam().open(directory_.path())) {
    panda_ = test::make_robot("panda", 1);
    iiwa_ = test::make_robot("iiwa", 2);
    EXPECT_TRUE(store_->register_robot(panda_));
    EXPECT_TRUE(store_->register_robot(iiwa_));
  }

  void reopen() {
    store_.reset();
    store_ = GetParam().open(directory_.path());
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

}  // namespace kinship::store
