#include "server/store/tables/distributions.hpp"

#include <mutex>
#include <set>
#include <thread>

#include "server/store/postgres/database/transaction.hpp"
#include "server/store/tables/rehearsals.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/store/postgres/empty_store.hpp"

/// Distributions and rehearsals that several servers store and forget at once.
namespace kinship::store::postgres::distribution_rows_test {
namespace {

class DistributionRows : public EmptyStore {
 protected:
  void SetUp() override {
    EmptyStore::SetUp();
    if (!IsSkipped())
      connection_->query("INSERT INTO task (name) VALUES ('shelf')");
    if (!IsSkipped())
      connection_->query(
          "INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,"
          " registered_ms, crc32c, urdf) VALUES ($1, 'panda', 7, 'base', 'tip',"
          " decode(repeat('00', 56), 'hex'), 0, 1, 0, '')",
          Bytes(robot_.bytes));
  }
  Distribution made(std::uint64_t number) const {
    return test::make_distribution(robot_, "shelf", number);
  }
  static std::uint64_t put(Connection& connection, const Distribution& distribution,
                           std::uint64_t max_bytes = 0) {
    Transaction transaction(connection, Transaction::Kind::Write);
    const std::uint64_t revision = upsert_distribution(connection, distribution, max_bytes);
    EXPECT_EQ(transaction.commit().certainty, Certainty::Committed);
    return revision;
  }
  static void put(Connection& connection, const StoredRehearsal& rehearsal) {
    {
      Transaction transaction(connection, Transaction::Kind::Write);
      insert_rehearsal(connection, rehearsal);
      EXPECT_EQ(transaction.commit().certainty, Certainty::Committed);
    }
    for (const std::int64_t row : find_surplus_rehearsals(connection, {}))
      drop_rehearsal(connection, row);
  }
  static void evict(Connection& connection, const Digest& id) {
    Transaction transaction(connection, Transaction::Kind::Write);
    delete_distribution(connection, id);
    EXPECT_EQ(transaction.commit().certainty, Certainty::Committed);
  }

  const Digest robot_ = test::id_from<Digest>(1);
};

TEST_F(DistributionRows, NoRevisionIsGivenTwiceWhoeverStoresAndForgets) {
  constexpr int kServers = 4, kFits = 25;
  std::mutex mutex;
  std::multiset<std::uint64_t> revisions;
  std::vector<std::jthread> servers;
  for (int server = 0; server < kServers; ++server)
    servers.emplace_back([&] {
      const auto connection = connect();
      for (int fit = 0; fit < kFits; ++fit) {
        const std::uint64_t revision = put(*connection, made(7), fit % 2 == 0 ? 1 : 0);
        if (fit % 3 == 0)
          evict(*connection, made(7).id);
        put(*connection, made(8), 1);  // for which the other one goes
        const std::lock_guard lock(mutex);
        revisions.insert(revision);
      }
    });
  servers.clear();
  EXPECT_EQ(revisions.size(), std::size_t{kServers} * kFits);
  EXPECT_EQ(std::set<std::uint64_t>(revisions.begin(), revisions.end()).size(), revisions.size());
  EXPECT_GT(put(*connection_, made(7)), *revisions.rbegin());
}

TEST_F(DistributionRows, TheOneNotUsedForLongestMakesRoom) {
  put(*connection_, made(1));
  const std::uint64_t one = bytes_of_distributions(*connection_);
  put(*connection_, made(2));
  put(*connection_, made(3));
  // The last row is the one not used for longest: neither ids nor places of rows are in this order.
  connection_->query("UPDATE distribution_use SET used_ms = used_ms - 7200000 - 1000 * id");
  note_use(*connection_, made(1).id);
  put(*connection_, made(4), 3 * one + one / 2);
  EXPECT_TRUE(select_distribution(*connection_, made(1).id).distribution);
  EXPECT_TRUE(select_distribution(*connection_, made(2).id).distribution);
  EXPECT_FALSE(select_distribution(*connection_, made(3).id).distribution);
  EXPECT_EQ(put(*connection_, made(3)), 2U) << "above that of what made room";
}

TEST_F(DistributionRows, ADamagedOneCountsAsAbsentAndIsWrittenOver) {
  put(*connection_, made(1));
  connection_->query("UPDATE distribution SET payload = overlay(payload PLACING '\\xff' FROM 9)");
  const DistributionRead read = select_distribution(*connection_, made(1).id);
  EXPECT_TRUE(read.damaged);
  EXPECT_FALSE(read.distribution);
  EXPECT_EQ(put(*connection_, made(1)), 2U);
  EXPECT_TRUE(select_distribution(*connection_, made(1).id).distribution);
}

TEST_F(DistributionRows, OfRehearsalsThatServersStoreAtOnceOneIsLeft) {
  constexpr std::uint64_t kServers = 4, kTimes = 10;
  std::vector<std::jthread> servers;
  for (std::uint64_t server = 0; server < kServers; ++server)
    servers.emplace_back([&] {
      const auto connection = connect();
      for (std::uint64_t i = 0; i < kTimes; ++i)
        put(*connection, test::make_rehearsal(robot_, "shelf", 1 + i % 2));
    });
  servers.clear();
  EXPECT_EQ(connection_->query("SELECT count(*) FROM rehearsal").front().column_integer(0), 2);
  EXPECT_EQ(select_rehearsals(*connection_, 10).size(), 2U);
}

TEST_F(DistributionRows, ADamagedRehearsalIsNoneAndIsWrittenOver) {
  put(*connection_, test::make_rehearsal(robot_, "shelf", 1));
  connection_->query("UPDATE rehearsal SET payload = overlay(payload PLACING '\\xff' FROM 90)");
  EXPECT_TRUE(select_rehearsals(*connection_, 10).empty());
  put(*connection_, test::make_rehearsal(robot_, "shelf", 1));
  EXPECT_EQ(select_rehearsals(*connection_, 10).size(), 1U);
}

}  // namespace
}  // namespace kinship::store::postgres::distribution_rows_test
