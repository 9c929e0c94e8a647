#pragma once

#include <sqlite3.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/store/open_store.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// Another program at a store: SQLite as it comes, which knows nothing of Kinship.
class Stranger {
 public:
  explicit Stranger(const std::filesystem::path& file, int flags = SQLITE_OPEN_READWRITE) {
    if (sqlite3_open_v2(file.c_str(), &connection_, flags, nullptr) != SQLITE_OK)
      throw std::runtime_error("a stranger cannot open " + file.string());
    sqlite3_busy_timeout(connection_, 10'000);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  ~Stranger() { sqlite3_close(connection_); }

  /// \return the first column of the last row. \throws std::runtime_error with SQLite's words.
  std::string run(const std::string& sql) {
    std::string value;
    char* words = nullptr;
    const auto keep = [](void* into, int, char** columns, char**) {
      *static_cast<std::string*>(into) = columns[0] != nullptr ? columns[0] : "";
      return 0;
    };
    if (sqlite3_exec(connection_, sql.c_str(), keep, &value, &words) != SQLITE_OK)
      throw std::runtime_error(sql + ": " + words);
    return value;
  }
  sqlite3* connection() { return connection_; }

 private:
  sqlite3* connection_ = nullptr;
};

/// A copy by SQLite's backup, as `.backup` of its shell makes it.
inline void copy_online(const std::filesystem::path& file, const std::filesystem::path& copy) {
  Stranger source(file);
  Stranger target(copy, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  sqlite3_backup* const backup =
      sqlite3_backup_init(target.connection(), "main", source.connection(), "main");
  if (sqlite3_backup_step(backup, -1) != SQLITE_DONE || sqlite3_backup_finish(backup) != SQLITE_OK)
    throw std::runtime_error("a stranger's backup failed");
}

/// kinshipd with a store in a folder of its own, and a ledger of the reports that it acknowledged.
class ServedStore {
 public:
  explicit ServedStore(std::vector<std::string> arguments = {})
      : cell_({.folder = folder_ / "client",
               .store = (made(folder_ / "store") / "fleet.db").string(),
               .arguments = std::move(arguments)}) {
    cell_.start();
    panda_ = cell_.register_model("panda").robot;
  }

  std::filesystem::path folder() const { return folder_ / "store"; }
  std::filesystem::path beside() const { return folder_.path(); }
  std::filesystem::path file() const { return folder() / "fleet.db"; }
  std::filesystem::path wal() const { return folder() / "fleet.db-wal"; }
  Cell& cell() { return cell_; }

  /// Durable on return.
  void report(std::uint64_t count) {
    for (const Uuid& uuid : cell_.report(panda_, next_, count))
      ledger_.push_back(uuid);
    next_ += count;
  }
  /// Sends one report. \return whether the server acknowledged it.
  bool offer() {
    const Attempt attempt = panda_attempt(panda_, "sweep", next_++);
    cell_.client().report(attempt);
    ledger_.push_back(attempt.report_uuid);
    return cell_.client().flush(std::chrono::seconds(1)).pending == 0;
  }
  /// Leaves a report with a path of some 430 kB that cannot be compressed to the client.
  void offer_long() {
    Attempt attempt = panda_attempt(panda_, "sweep", next_++);
    std::mt19937_64 generator(next_);
    std::uniform_real_distribution<double> joint(-0.5, 0.5);
    Eigen::MatrixXd waypoints =
        Eigen::MatrixXd::NullaryExpr(7, 8000, [&] { return joint(generator); });
    waypoints.row(3).array() -= 1.5;  // within the limits
    waypoints.row(5).array() += 1.5;
    attempt.path = Path(waypoints);
    cell_.client().report(attempt);
    ledger_.push_back(attempt.report_uuid);
  }
  const Digest& robot() const { return panda_; }

  /// Waits until the client has receipts of all that it offered.
  bool has_all_receipts() { return cell_.client().flush(Cell::kEnough).pending == 0; }

  /// Asks for the status until it is as wanted, for as long as that is sure to take.
  bool status_becomes(const std::function<bool(const ServerStatus&)>& wanted) {
    const auto end = std::chrono::steady_clock::now() + Cell::kEnough;
    while (std::chrono::steady_clock::now() < end)
      if (wanted(cell_.status()))
        return true;
    return false;
  }

  /// How many of the ledger a store lacks. No server may have it open.
  std::size_t missing(const std::filesystem::path& file) const {
    store::SqliteOptions options;
    options.scrub_bytes_per_s = 0;
    const auto store = store::open_sqlite_store(file, options);
    std::size_t missing = 0;
    for (const Uuid& uuid : ledger_)
      missing += store->find_attempt(uuid) ? 0U : 1U;
    return missing;
  }

  /// kinshipd with a verb: "check", "restore", ... of this store.
  Answer offline(const std::string& verb, const std::vector<std::string>& further = {}) const {
    return offline_of(file(), verb, further);
  }
  static Answer offline_of(const std::filesystem::path& file, const std::string& verb,
                           const std::vector<std::string>& further = {}) {
    std::vector<std::string> arguments = {verb, "--store", file.string()};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_to_end("kinshipd", arguments);
  }
  /// kinshipd as a server that is expected to refuse.
  Answer start_in_vain(const std::filesystem::path& file,
                       const std::vector<std::string>& further = {}) const {
    const ReservedDomain domain;
    std::vector<std::string> arguments = {"--store", file.string(), "--domain",
                                          std::to_string(domain.number())};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_to_end("kinshipd", arguments);
  }

  /// Names in the store's folder that begin so.
  std::vector<std::filesystem::path> named(const std::string& begin) const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder()))
      if (entry.path().filename().string().starts_with(begin))
        found.push_back(entry.path());
    return found;
  }

 private:
  static std::filesystem::path made(const std::filesystem::path& folder) {
    std::filesystem::create_directory(folder);
    return folder;
  }

  const TemporaryDirectory folder_;
  Cell cell_;
  Digest panda_;
  std::uint64_t next_ = 1;
  std::vector<Uuid> ledger_;
};

}  // namespace kinship::test
