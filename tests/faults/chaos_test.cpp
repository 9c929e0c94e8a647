#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/security/security_folder.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/chaos_fleet.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/small_file_system.hpp"

/// Whatever happens to a fleet's processes, disk, clock and database: what report() took is in the
/// store at the end, once, with its content. KINSHIP_CHAOS_S says how long each of the three goes
/// on (with KINSHIP_LONG=1 200 s), KINSHIP_CHAOS_SEED in which order.
namespace kinship::test::chaos_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
namespace fs = std::filesystem;

std::uint64_t wish(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text ? std::stoull(text) : otherwise;
}
seconds chaos_time() { return seconds(wish("KINSHIP_CHAOS_S", is_long_run() ? 200 : 10)); }
std::uint64_t chaos_seed() { return wish("KINSHIP_CHAOS_SEED", 20261128); }

void pause(Dice& dice, milliseconds from, milliseconds to) {
  std::this_thread::sleep_for(dice.time(from, to));
}

/// What the three have in common.
class Chaos : public testing::Test {
 protected:
  static constexpr std::size_t kClients = 5;

  std::unique_ptr<Supervised> make_server(const std::string& name,
                                          std::vector<std::string> arguments) {
    return std::make_unique<Supervised>(clock_, "kinshipd", folder_ / (name + ".log").c_str(),
                                        [arguments = std::move(arguments)] { return arguments; });
  }
  std::vector<std::string> arguments_of(const std::string& store,
                                        std::vector<std::string> others) const {
    // All paths, as sites do not bring each other an attempt whose path is not kept.
    others.insert(others.end(),
                  {"--store", store, "--rehearsal-cpu", "0", "--max-paths-per-pair", "0"});
    return others;
  }

  static Nuisance kill_of(const std::string& name, Supervised& server) {
    return {"kill " + name, [&server](Dice& dice) {
              server.kill();
              pause(dice, milliseconds(0), milliseconds(200));
              server.start();
              if (dice.one_in(2)) {  // while it opens its store
                pause(dice, milliseconds(0), milliseconds(150));
                server.kill();
                server.start();
              }
            }};
  }
  static Nuisance freeze_of(const std::string& name, Supervised& server) {
    return {"freeze " + name, [&server](Dice& dice) {
              server.freeze_for(dice.time(milliseconds(50), milliseconds(4000)));
            }};
  }
  /// Killed, frozen or stopped.
  void add_server_nuisances(const std::string& name, Supervised& server,
                            std::vector<Nuisance>& nuisances) {
    nuisances.push_back(kill_of(name, server));
    nuisances.push_back(freeze_of(name, server));
    nuisances.push_back({"stop " + name, [&server](Dice& dice) {
                           server.terminate();  // not 0 if it was still starting
                           pause(dice, milliseconds(0), milliseconds(200));
                           server.start();
                         }});
  }
  std::vector<Nuisance> common_nuisances() {
    return {{"kill a client", [this](Dice& dice) { clients_->any(dice).kill_and_start(); }},
            {"freeze a client",
             [this](Dice& dice) {
               clients_->any(dice).freeze_for(dice.time(milliseconds(50), milliseconds(3000)));
             }},
            {"clock", [this](Dice& dice) { jump(dice); }}};
  }
  /// By hours to stay, by days and years for a moment: certificates are valid for a year.
  void jump(Dice& dice) {
    constexpr seconds kHour{3600};
    const std::vector<seconds> ahead = {-kHour,      kHour,       20 * kHour,
                                        -20 * kHour, 480 * kHour, -3 * 8760 * kHour};
    const seconds chosen = ahead[dice.below(ahead.size())];
    clock_.jump_to(chosen);
    pause(dice, milliseconds(500), milliseconds(3000));
    if (chosen > 24 * kHour || chosen < -24 * kHour)
      clock_.jump_to(seconds(0));
  }

  void run(const std::vector<Nuisance>& nuisances, const std::vector<Supervised*>& servers) {
    for (Supervised* const server : servers)
      server->start();
    clients_->start_all();
    run_chaos(chaos_seed(), chaos_time(), nuisances, [&] {
      for (Supervised* const server : servers)
        server->keep_up();
      clients_->keep_up();
    });
    clock_.jump_to(seconds(0));
    for (Supervised* const server : servers)
      server->keep_up();
    clients_->drain();
  }
  void expect_all_in(const store::Store& store) const {
    const ReportLedger ledger = clients_->ledger();
    const FleetAudit audit = audit_fleet(store, model_chain("panda").digest(), ledger);
    expect_nothing_wrong(audit);
    std::cout << "accepted " << ledger.accepted.size() << " reports, stored " << audit.stored
              << std::endl;
    EXPECT_GT(ledger.accepted.size(), 100U);
  }
  static void expect_sound(const fs::path& file) {
    const StoreCheck check = store::check_store(file, [](double) {});
    EXPECT_EQ(check.problems, 0U) << (check.messages.empty() ? "" : check.messages.front());
  }

  const TemporaryDirectory folder_;
  const JumpingClock clock_{folder_ / "clock"};
  const ReservedDomain domain_;
  std::unique_ptr<ChaosClients> clients_;
};

/// A server with security and a small disk.
class ChaosOfOneFile : public Chaos {
 protected:
  void SetUp() override {
    if (!disk_.is_mounted())
      GTEST_SKIP() << "no small file system can be mounted here: " << disk_.why();
    const fs::path fleet = folder_ / "fleet";
    const auto now = std::chrono::floor<seconds>(std::chrono::system_clock::now());
    const security::SecurityFolder security =
        security::SecurityFolder::init(fleet, security::kDefaultDays, now);
    std::vector<ChaosClients::Place> places;
    for (std::size_t client = 0; client < kClients; ++client) {
      const std::string name = "r" + std::to_string(client);
      places.push_back({domain_.number(), folder_ / name.c_str()});
      security.add({.name = name}, places.back().credentials, now);
    }
    security.add({.name = "anna", .role = AccessRole::Admin}, admin_, now);
    clients_ = std::make_unique<ChaosClients>(folder_.path(), clock_, places, kClients);
    server_ = make_server(
        "server", arguments_of(store_, {"--domain", std::to_string(domain_.number()), "--security",
                                        fleet, "--backup-folder", folder_.path(),
                                        "--free-space-watermark-mb", "1", "--ballast-mb", "1"}));
  }

  static fs::path made(const fs::path& folder) {
    fs::create_directory(folder);
    return folder;
  }
  /// Takes all room for some time; the server may be killed and started in it.
  void fill_disk(Dice& dice) const {
    const fs::path filler = store_.parent_path() / "filler";
    const int file = open(filler.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ASSERT_GE(file, 0);
    for (off_t end = 0, part = off_t{1} << 22; part >= 4096;)
      if (posix_fallocate(file, end, part) == 0)
        end += part;
      else
        part /= 2;
    close(file);
    pause(dice, milliseconds(100), milliseconds(2000));
    if (dice.one_in(2)) {
      server_->kill_and_start();
      pause(dice, milliseconds(0), milliseconds(1000));
    }
    fs::remove(filler);
  }
  /// Of the running server; it may have none just now.
  void back_up() {
    const std::string name = "copy-" + std::to_string(++backups_) + ".db";
    const Answer answer = run_to_end(
        "kinship", words("--domain " + std::to_string(domain_.number()) +
                         " --timeout 5 --security " + admin_.string() + " backup " + name));
    if (answer.code == 0)
      backup_ = folder_ / name.c_str();
  }
  /// Clients offer again what the copy lacks.
  void restore() {
    if (backup_.empty())
      return;
    server_->terminate();
    const Answer answer =
        run_to_end("kinshipd", {"restore", "--store", store_.string(), backup_.string()});
    EXPECT_EQ(answer.code, 0) << answer.err;
    for (const auto& file : fs::directory_iterator(store_.parent_path()))
      if (file.path().filename().string().find(".replaced-") != std::string::npos)
        fs::remove(file.path());
    ++restores_;
    server_->start();
  }

  const fs::path admin_ = folder_ / "anna";
  const fs::path disk_folder_ = made(folder_ / "disk");
  const SmallFileSystem disk_{disk_folder_, std::to_string(64 + 2 * chaos_time().count()) + "m"};
  const fs::path store_ = disk_folder_ / "fleet.db";
  std::unique_ptr<Supervised> server_;
  int backups_ = 0, restores_ = 0;
  fs::path backup_;
};

TEST_F(ChaosOfOneFile, LosesNothing) {
  std::vector<Nuisance> nuisances = common_nuisances();
  add_server_nuisances("the server", *server_, nuisances);
  nuisances.push_back({"fill the disk", [this](Dice& dice) { fill_disk(dice); }});
  nuisances.push_back({"back up", [this](Dice&) { back_up(); }});
  nuisances.push_back({"restore", [this](Dice&) { restore(); }});
  run(nuisances, {server_.get()});
  if (is_long_run()) {
    EXPECT_GT(restores_, 0);
  }
  EXPECT_EQ(server_->terminate(), 0);
  expect_sound(store_);
  expect_all_in(*store::open_sqlite_store(store_));
}

/// A server over a database whose primary dies.
class ChaosOfADatabase : public Chaos {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    primary_ = std::make_unique<PostgresCluster>(PostgresCluster::Options{
        .name = "a", .settings = {"synchronous_standby_names = 'ANY 1 (a, b)'"}});
    primary_->create_database("fleet");
    standby_ = std::make_unique<PostgresCluster>(*primary_, PostgresCluster::Options{.name = "b"});
    url_ = url_of_either(*primary_, *standby_, "fleet");
    server_ =
        make_server("server", arguments_of(url_, {"--domain", std::to_string(domain_.number()),
                                                  "--require-synchronous"}));
    clients_ = std::make_unique<ChaosClients>(
        folder_.path(), clock_, std::vector<ChaosClients::Place>{{domain_.number()}}, kClients);
  }
  void lose_the_primary(Dice& dice) {
    if (dice.one_in(2)) {
      standby_->freeze_receiver();
      pause(dice, milliseconds(0), milliseconds(300));
    }
    lose_primary(*primary_, *standby_);
    standby_->promote();
    std::swap(primary_, standby_);
    pause(dice, milliseconds(0), milliseconds(1000));
    standby_->rewind_and_follow(*primary_);
  }
  void end_sessions(Dice& dice) const {
    const std::string how = dice.one_in(2) ? "pg_cancel_backend" : "pg_terminate_backend";
    for (std::size_t times = 1 + dice.below(20); times > 0; --times)
      primary_->query("SELECT " + how +
                      "(pid) FROM pg_stat_activity WHERE datname = 'fleet' AND pid <> "
                      "pg_backend_pid()");
  }

  std::unique_ptr<PostgresCluster> primary_, standby_;
  std::string url_;
  std::unique_ptr<Supervised> server_;
};

TEST_F(ChaosOfADatabase, LosesNothing) {
  std::vector<Nuisance> nuisances = common_nuisances();
  add_server_nuisances("the server", *server_, nuisances);
  nuisances.push_back({"lose the primary", [this](Dice& dice) { lose_the_primary(dice); }});
  nuisances.push_back({"end sessions", [this](Dice& dice) { end_sessions(dice); }});
  nuisances.push_back({"freeze the primary", [this](Dice& dice) {
                         primary_->freeze();
                         pause(dice, milliseconds(100), milliseconds(3000));
                         primary_->thaw();
                       }});
  nuisances.push_back({"freeze the standby", [this](Dice& dice) {
                         standby_->freeze();
                         pause(dice, milliseconds(100), milliseconds(3000));
                         standby_->thaw();
                       }});
  run(nuisances, {server_.get()});
  EXPECT_EQ(server_->terminate(), 0);
  expect_all_in(*store::open_postgres_store(url_));
}

/// Two servers with a store each, and the memory above them.
class ChaosOfTwoSites : public Chaos {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    memory_ = std::make_unique<PostgresCluster>();
    url_ = memory_->create_database("kinship");
    std::vector<ChaosClients::Place> places;
    for (std::size_t site = 0; site < 2; ++site) {
      places.push_back({domain_of(site)});
      servers_.push_back(make_server(
          "site-" + std::to_string(site),
          arguments_of(store_of(site), {"--domain", std::to_string(domain_of(site)), "--upstream",
                                        url_, "--upstream-tasks", "sweep_*"})));
    }
    clients_ = std::make_unique<ChaosClients>(folder_.path(), clock_, places, kClients);
  }
  std::uint32_t domain_of(std::size_t site) const {
    return site == 0 ? domain_.number() : other_domain_.number();
  }
  fs::path store_of(std::size_t site) const {
    return folder_ / ("site-" + std::to_string(site) + ".db").c_str();
  }
  /// Until both have sent what they have, and hold what the memory has.
  void wait_for_union() const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(3);
    for (std::size_t site = 0; site < 2; ++site) {
      link::Client client({.domain = domain_of(site), .outbox = {}, .has_outbox = false});
      std::string last = "none";
      const auto is_done = [&] {
        const Result<AdminReply> reply = client.admin({});
        if (!reply || reply->rows.empty())
          return false;
        last = reply->rows.front();
        const auto status = json::row_from_json<ServerStatus>(last).value_or_throw();
        return status.upstream && status.upstream->waiting == 0 &&
               std::to_string(status.attempts) ==
                   memory_->query("SELECT count(*) FROM attempt", "kinship");
      };
      while (!is_done()) {
        ASSERT_LT(std::chrono::steady_clock::now(), end) << last;
        std::this_thread::sleep_for(milliseconds(100));
      }
    }
  }

  const ReservedDomain other_domain_;
  std::unique_ptr<PostgresCluster> memory_;
  std::string url_;
  std::vector<std::unique_ptr<Supervised>> servers_;
};

TEST_F(ChaosOfTwoSites, BothEndWithAll) {
  std::vector<Nuisance> nuisances = common_nuisances();
  for (std::size_t site = 0; site < 2; ++site)
    add_server_nuisances("site " + std::to_string(site), *servers_[site], nuisances);
  nuisances.push_back({"kill the memory", [this](Dice& dice) {
                         memory_->kill();
                         pause(dice, milliseconds(0), milliseconds(2000));
                         memory_->start();
                       }});
  nuisances.push_back({"freeze the memory", [this](Dice& dice) {
                         memory_->freeze();
                         pause(dice, milliseconds(100), milliseconds(5000));
                         memory_->thaw();
                       }});
  run(nuisances, {servers_[0].get(), servers_[1].get()});
  wait_for_union();
  for (std::size_t site = 0; site < 2; ++site) {
    EXPECT_EQ(servers_[site]->terminate(), 0);
    expect_sound(store_of(site));
    expect_all_in(*store::open_sqlite_store(store_of(site)));
  }
  expect_all_in(*store::open_postgres_store(url_));
}

}  // namespace
}  // namespace kinship::test::chaos_test
