#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// kinshipd and clients that report to it, as processes that can be killed, with a ledger of what
/// report() returned for.
class ReportingFleet : public testing::Test {
 protected:
  void start_server(const std::filesystem::path& store) {
    server_.reset();
    server_ = std::make_unique<ServerProcess>(
        ServerProcess::Options{.store = store, .domain = domain_.number()});
  }
  void start_server() { start_server(store_); }
  void kill_server() {
    server_->kill();
    server_.reset();
  }
  /// The description also goes into the outbox, from where every sender registers it if need be.
  void register_panda(const std::string& outbox) {
    link::Client client({.domain = domain_.number(), .outbox = directory_.path() / outbox});
    ASSERT_TRUE(client.register_robot(model_description("panda")));
  }
  std::unique_ptr<ChildProcess> start_client(const std::string& outbox, std::uint64_t first,
                                             std::uint64_t count) const {
    return std::make_unique<ChildProcess>(std::vector<std::string>{
        KINSHIP_REPORTING_CLIENT, std::to_string(domain_.number()),
        (directory_.path() / outbox).string(), std::to_string(first), std::to_string(count)});
  }
  /// Reads what a client reported, until it has ended or all of it has a receipt.
  /// \return whether the latter.
  bool read_ledger(ChildProcess& client) {
    while (true) {
      const std::string line = client.read_line();
      if (line == "acknowledged")
        return true;
      if (const std::optional<Uuid> uuid = Uuid::parse(line))
        ledger_.insert(*uuid);
      else
        return false;
    }
  }
  ServerStatus status() {
    if (!observer_)
      observer_ = std::make_unique<link::Client>(
          link::ClientOptions{.domain = domain_.number(), .outbox = {}, .has_outbox = false});
    const Result<AdminReply> reply = observer_->admin({});
    return reply && !reply->rows.empty()
               ? json::row_from_json<ServerStatus>(reply->rows.front()).value_or_throw()
               : ServerStatus{};
  }
  /// \return the last status, which the condition holds for unless two minutes have passed.
  ServerStatus wait_for(const std::function<bool(const ServerStatus&)>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    ServerStatus last = status();
    while (!condition(last) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      last = status();
    }
    return last;
  }
  std::size_t reports_in(const std::string& outbox, const char* part) const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path() / outbox / part))
      if (entry.path().extension() == ".json")
        ++count;
    return count;
  }
  /// Ends the server; then everything in the ledger is in its store, sound and counted once.
  /// \return how many attempts there are.
  std::uint64_t expect_ledger_in(const std::filesystem::path& file) {
    server_->terminate();
    server_.reset();
    const StoreCheck check = store::check_store(file, [](double) {});
    EXPECT_EQ(check.problems, 0U) << testing::PrintToString(check.messages);
    const std::unique_ptr<store::Store> store = store::open_sqlite_store(file);
    std::size_t missing = 0;
    for (const Uuid& uuid : ledger_)
      if (!store->find_attempt(uuid))
        ++missing;
    EXPECT_EQ(missing, 0U) << "of " << ledger_.size();
    const store::StoreStatus status = store->status();
    const Digest panda = model_chain("panda").digest();
    EXPECT_EQ(store->attempt_totals(panda, "sweep").control.attempts, status.attempts);
    EXPECT_EQ(status.paths, status.attempts);
    return status.attempts;
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  const std::filesystem::path store_ = directory_ / "fleet.db";
  std::unique_ptr<ServerProcess> server_;
  std::unique_ptr<link::Client> observer_;
  std::set<Uuid> ledger_;
};

}  // namespace kinship::test
