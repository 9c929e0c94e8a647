#include "server/app/revocation_watch.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "proto/security/private_files.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app::revocation_watch_test {
namespace {

using security::SecurityFolder;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::chrono::sys_seconds now_s() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// A security folder, and what a server knows of its clients while it runs.
struct Server {
  Server(const fs::path& folder, store::Store& store)
      : fleet(folder),
        clients(fleet.clients()),
        watch(fleet, clients, store, [](std::string_view) {}) {}

  SecurityFolder fleet;
  security::ClientDirectory clients;
  RevocationWatch watch;
};

class RevocationWatchTest : public testing::Test {
 protected:
  SecurityFolder init(const std::string& name) {
    return SecurityFolder::init(folder_ / name.c_str(), security::kDefaultDays, now_s());
  }
  void add(const SecurityFolder& fleet, const std::string& name) {
    fleet.add({.name = name}, folder_ / ("out-" + std::to_string(++outs_)).c_str(), now_s());
  }
  std::size_t acts(const std::string& verb) const {
    std::size_t count = 0;
    for (const AuditEntry& entry : store_->list_audit("server", "", 100).rows)
      count += entry.verb == verb ? 1 : 0;
    return count;
  }
  void wait_for(const std::string& verb) const {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (acts(verb) == 0)
      ASSERT_LT(std::chrono::steady_clock::now(), end) << verb;
  }

  const test::TemporaryDirectory folder_;
  const std::unique_ptr<store::Store> store_ = store::open_sqlite_store(folder_ / "s.db");
  int outs_ = 0;
};

TEST_F(RevocationWatchTest, ARevocationHoldsForTheFleetOfItsAuthorityAlone) {
  const SecurityFolder ulm = init("ulm"), bern = init("bern");
  add(ulm, "bob");
  add(bern, "bob");
  const fs::path record = ulm.clients() / "bob.toml";
  const std::string before = security::read_file(record);
  {
    const Server server(folder_ / "ulm", *store_);
    ulm.revoke("bob", now_s());
    wait_for("revoke");
  }
  security::replace_file(record, before, security::Readers::Everybody);
  const Server again(folder_ / "ulm", *store_), other(folder_ / "bern", *store_);
  EXPECT_FALSE(again.clients.caller("bob", now_s()));
  EXPECT_TRUE(other.clients.caller("bob", now_s())) << "another one's bob";
  wait_for("revoke_again");
  EXPECT_NE(security::read_file(record).find("revoked = "), std::string::npos);
  EXPECT_EQ(acts("trust_authorities"), 2U) << "once a folder";
}

TEST_F(RevocationWatchTest, ItHoldsWhenTheFolderIsPutBackBehindAChangeOfItsAuthority) {
  SecurityFolder fleet = init("fleet");
  add(fleet, "bob");
  fs::copy(folder_ / "fleet", folder_ / "copy", fs::copy_options::recursive);
  fleet.renew_authority(security::kDefaultDays, now_s());
  { const Server server(folder_ / "fleet", *store_); }
  fleet.retire_authority(security::kDefaultDays, now_s());
  {
    const Server server(folder_ / "fleet", *store_);
    fleet.revoke("bob", now_s());
    wait_for("revoke");
  }
  const Server server(folder_ / "copy", *store_);
  EXPECT_FALSE(server.clients.caller("bob", now_s()));
}

TEST_F(RevocationWatchTest, NoNumberOfCredentialsIsIssuedTwice) {
  const SecurityFolder fleet = init("fleet");
  add(fleet, "bob");
  const fs::path record = fleet.clients() / "bob.toml";
  const std::string before = security::read_file(record);
  const Server server(folder_ / "fleet", *store_);
  fleet.renew("bob", security::kDefaultDays, folder_ / "second", now_s());
  wait_for("issue_credentials");
  security::replace_file(record, before, security::Readers::Everybody);
  wait_for("revoke_again");
  EXPECT_EQ(fleet.renew("bob", security::kDefaultDays, folder_ / "third", now_s()).generation, 3U);
}

}  // namespace
}  // namespace kinship::app::revocation_watch_test
