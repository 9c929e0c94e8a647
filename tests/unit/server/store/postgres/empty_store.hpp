#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/opening/opening.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"

namespace kinship::store::postgres {

/// Databases with the schema of today, one a test, in one cluster for all.
class EmptyStore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!test::missing_postgres().empty())
      return;
    cluster_ = std::make_unique<test::PostgresCluster>();
    open_store_connection(ConnectionString(cluster_->create_database("pattern")), {});
  }
  static void TearDownTestSuite() { cluster_.reset(); }

  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    url_ = cluster_->create_database("of_" + std::to_string(test.line()), "pattern");
    connection_ = connect();
  }
  std::unique_ptr<Connection> connect() const {
    return std::make_unique<Connection>(ConnectionString(url_));
  }

  inline static std::unique_ptr<test::PostgresCluster> cluster_;
  std::string url_;
  std::unique_ptr<Connection> connection_;
};

}  // namespace kinship::store::postgres
