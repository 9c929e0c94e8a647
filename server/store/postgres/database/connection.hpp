#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/connection_string.hpp"
#include "server/store/postgres/database/parameters.hpp"
#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/rows.hpp"
#include "server/store/session.hpp"

struct pg_conn;

namespace kinship::store::postgres {

/// Ends waits for a database: once raised, every wait of the connections that have it ends at once.
/// May be shared between threads.
class Interrupt {
 public:
  /// \throws Failure(Internal) if the system has no descriptor left.
  Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  void raise() noexcept;
  bool is_raised() const noexcept;
  int descriptor() const noexcept { return descriptor_; }  ///< readable once it is raised

 private:
  int descriptor_;
};

/// A statement with its parameters.
struct Request {
  std::string_view sql;
  Parameters parameters = {};
};

struct ConnectionOptions {
  /// Time limit of one statement, or of a pipeline of them, after which the connection is given up.
  std::chrono::milliseconds patience{10'000};
  const Interrupt* interrupt = nullptr;  ///< ends every wait; outlives the connection
  /// Set once a connection pooler is found, which gives each transaction another session: then
  /// statements are not kept prepared. Null: they always are.
  std::atomic<bool>* is_pooled = nullptr;
};

/// A connection to PostgreSQL: the owner of one PGconn. Used by one thread at a time. Statements
/// are prepared when they are first run. Every method throws PostgresError, whose message names no
/// password; after one of kind Lost the connection is of no use any more.
class Connection : public Session {
 public:
  /// Waits at most a few seconds for each host.
  explicit Connection(const ConnectionString& where, const ConnectionOptions& options = {});
  ~Connection() override;

  const Dialect& dialect() const noexcept override;
  std::string is_quarantined(std::string_view table) const override;

  /// Runs one statement with its parameters.
  template <typename... Values>
  Rows query(std::string_view sql, const Values&... values) {
    return run_one({sql, Parameters(values...)});
  }
  Rows query(std::string_view sql, const Parameters& parameters) {
    return run_one({sql, parameters});
  }

  /// Runs statements one after the other in one round trip (pipeline mode). The first that fails
  /// ends them and is thrown; outside of a transaction those before it are undone too.
  /// \return the rows of each.
  std::vector<Rows> query_all(std::span<const Request> requests);

  /// Runs a script of statements without parameters, drops rows. Takes as long as it takes.
  void execute(const std::string& script);

  /// COMMIT, however long it takes: only the interrupt ends the wait.
  Rows query_without_limit(std::string_view sql);

  /// Host and database, for messages, without a password.
  const std::string& description() const noexcept { return where_.description(); }
  bool is_alive() const noexcept;  ///< as far as libpq knows
  bool in_transaction() const noexcept;
  int server_version() const noexcept;            ///< 150004 for 15.4
  std::string parameter(const char* name) const;  ///< reported by the server; empty: none

  /// The first WARNING since the last call; empty: none.
  std::string take_warning();

  /// Closes the socket, even during a statement.
  void abandon() noexcept;

 private:
  using Deadline = std::optional<std::chrono::steady_clock::time_point>;  // empty: none

  struct Finish {
    void operator()(pg_conn* connection) const noexcept;
  };

  /// The statement of one answer of a pipeline.
  struct Command {
    std::string_view sql;
    bool is_preparation = false;
  };

  store::Row& run(std::string_view sql, std::span<const Parameter> parameters) override;
  Rows run_one(const Request& request);
  bool keeps_statements() const noexcept {
    return options_.is_pooled == nullptr || !*options_.is_pooled;
  }
  std::vector<Rows> run(std::span<const Request> requests, Deadline deadline);
  std::vector<Command> send(std::span<const Request> requests);
  const std::string& name_of(const Request& request, std::vector<Command>& commands);
  void send_one(const Request& request, std::vector<Command>& commands);
  std::vector<Rows> receive(const std::vector<Command>& commands, Deadline deadline);
  pg_result* next_result(Deadline deadline);
  void flush(Deadline deadline);
  void wait(short events, Deadline deadline);
  Deadline deadline() const;
  [[noreturn]] void throw_lost(const std::string& doing);
  PostgresError error_of(const pg_result* result, std::string_view sql);
  static void notice(void* self, const pg_result* result);

  ConnectionString where_;
  ConnectionOptions options_;
  std::string warning_;
  std::map<std::string, std::string, std::less<>> statements_;  // text -> name
  std::unique_ptr<pg_conn, Finish> connection_;
};

}  // namespace kinship::store::postgres
