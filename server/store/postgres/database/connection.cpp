#include "server/store/postgres/database/connection.hpp"

#include <libpq-fe.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/sha256.hpp"
#include "server/store/postgres/database/postgres_error.hpp"

namespace kinship::store::postgres {
namespace {

constexpr int kBinary = 1;

/// libpq's messages end with a line break, and may have several lines.
std::string one_line(const char* text) {
  std::string line = text == nullptr ? "" : text;
  while (!line.empty() && (line.back() == '\n' || line.back() == ' '))
    line.pop_back();
  std::ranges::replace_if(
      line, [](char each) { return each == '\n' || each == '\t'; }, ' ');
  return line;
}

std::string field(const pg_result* result, int code) {
  return one_line(PQresultErrorField(result, code));
}

/// The name of a prepared statement. Another session that a pooler gave us may have a statement of
/// that name: then it is the same one.
std::string name_by(std::string_view sql) {
  constexpr std::size_t kDigits = 24;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sql.data());
  return "k" + Sha256().add(Bytes(bytes, sql.size())).finish().hex().substr(0, kDigits);
}

/// The first words of a statement, to find it in the sources.
std::string begin_of(std::string_view sql) {
  constexpr std::size_t kShown = 60;
  return std::string(sql.substr(0, kShown));
}

/// The rows of an answer, one after the other; on the heap, owned by itself.
class AnswerRow final : public store::Row {
 public:
  explicit AnswerRow(Rows rows) : rows_(std::move(rows)) {}
  bool next() override { return ++row_ < rows_.size(); }
  int columns() const noexcept override { return rows_.columns(); }
  std::int64_t column_integer(int column) const override {
    return rows_[row_].column_integer(column);
  }
  double column_real(int column) const override { return rows_[row_].column_real(column); }
  std::string_view column_text(int column) const override {
    return rows_[row_].column_text(column);
  }
  Bytes column_blob(int column) const override { return rows_[row_].column_blob(column); }
  bool column_is_null(int column) const override { return rows_[row_].column_is_null(column); }

 private:
  void release() noexcept override { delete this; }

  Rows rows_;
  int row_ = -1;
};

}  // namespace

Interrupt::Interrupt() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0)
    throw Failure(ErrorCode::Internal, "no descriptor is left for an eventfd");
}

Interrupt::~Interrupt() { close(descriptor_); }

bool Interrupt::is_raised() const noexcept {
  pollfd waited{.fd = descriptor_, .events = POLLIN, .revents = 0};
  return poll(&waited, 1, 0) > 0;
}

void Interrupt::raise() noexcept { static_cast<void>(eventfd_write(descriptor_, 1)); }

Connection::Connection(const ConnectionString& where, const ConnectionOptions& options)
    : where_(where), options_(options) {
  if (options_.interrupt != nullptr && options_.interrupt->is_raised())
    throw PostgresError("", where_.description() + ": the server is stopping");
  std::vector<const char*> keywords, values;
  for (const auto& [keyword, value] : where_.parameters()) {
    keywords.push_back(keyword.c_str());
    values.push_back(value.c_str());
  }
  keywords.push_back(nullptr);
  values.push_back(nullptr);
  constexpr int kNamesNoDatabase = 0;  // "dbname" is a name, not another connection string
  connection_.reset(PQconnectdbParams(keywords.data(), values.data(), kNamesNoDatabase));
  if (!connection_)
    throw std::bad_alloc();
  if (PQstatus(connection_.get()) != CONNECTION_OK)
    throw_lost(PQconnectionNeedsPassword(connection_.get()) == 0
                   ? "connecting"
                   : "connecting without a password (~/.pgpass has none for it)");
  PQsetnonblocking(connection_.get(), 1);
  PQsetNoticeReceiver(connection_.get(), &Connection::notice, this);
}

Connection::~Connection() = default;

void Connection::Finish::operator()(pg_conn* connection) const noexcept { PQfinish(connection); }

void Connection::notice(void* self, const pg_result* result) {
  auto& connection = *static_cast<Connection*>(self);
  if (connection.warning_.empty() && field(result, PG_DIAG_SEVERITY_NONLOCALIZED) == "WARNING")
    connection.warning_ = field(result, PG_DIAG_MESSAGE_PRIMARY);
}

std::string Connection::take_warning() { return std::exchange(warning_, {}); }

bool Connection::is_alive() const noexcept {
  return connection_ && PQstatus(connection_.get()) == CONNECTION_OK;
}

bool Connection::in_transaction() const noexcept {
  return connection_ && PQtransactionStatus(connection_.get()) != PQTRANS_IDLE;
}

int Connection::server_version() const noexcept {
  return connection_ ? PQserverVersion(connection_.get()) : 0;
}

std::string Connection::parameter(const char* name) const {
  const char* const value = connection_ ? PQparameterStatus(connection_.get(), name) : nullptr;
  return value == nullptr ? "" : value;
}

void Connection::abandon() noexcept { connection_.reset(); }

Connection::Deadline Connection::deadline() const {
  return std::chrono::steady_clock::now() + options_.patience;
}

const Dialect& Connection::dialect() const noexcept {
  static constexpr Dialect kDialect = {
      // Robots are registered, renamed and removed one at a time; reports, which lock rows FOR KEY
      // SHARE, go on with the other robots.
      .lock_robots = "LOCK TABLE robot IN SHARE ROW EXCLUSIVE MODE",
      .for_update = " FOR UPDATE",
      .lock_experience = " FOR NO KEY UPDATE",
      .mark_changed = ", changed_in = pg_current_xact_id()",
      .note_gone_robot =
          "INSERT INTO gone_robot (digest) SELECT digest FROM robot WHERE id = $1"
          " ON CONFLICT (digest) DO UPDATE SET changed_in = excluded.changed_in",
      .note_former_task =
          "INSERT INTO former_task (name) VALUES ($1)"
          " ON CONFLICT (name) DO UPDATE SET changed_in = excluded.changed_in",
      .newest_attempts_first = "arrived_in DESC, id DESC"};
  return kDialect;
}

std::string Connection::is_quarantined(std::string_view table) const {
  if (table == "distribution")
    return "FALSE";
  return "(" + std::string(table) + ".damaged_ms IS NOT NULL)";
}

store::Row& Connection::run(std::string_view sql, std::span<const Parameter> parameters) {
  Request request{sql};
  for (const Parameter& parameter : parameters)
    request.parameters.add(parameter);
  return *std::make_unique<AnswerRow>(run_one(request)).release();
}

Rows Connection::run_one(const Request& request) {
  return std::move(run(std::span(&request, 1), deadline()).front());
}

std::vector<Rows> Connection::query_all(std::span<const Request> requests) {
  return requests.empty() ? std::vector<Rows>() : run(requests, deadline());
}

Rows Connection::query_without_limit(std::string_view sql) {
  const Request request{sql};
  return std::move(run(std::span(&request, 1), std::nullopt).front());
}

void Connection::execute(const std::string& script) {
  if (!connection_ || PQsendQuery(connection_.get(), script.c_str()) != 1)
    throw_lost("sending a script");
  const Deadline until;
  flush(until);
  std::optional<PostgresError> failed;
  while (pg_result* const result = next_result(until)) {
    const Rows rows(result);
    if (PQresultStatus(result) == PGRES_FATAL_ERROR && !failed)
      failed = error_of(result, script);
  }
  if (failed)
    throw PostgresError(*failed);
}

std::vector<Rows> Connection::run(std::span<const Request> requests, Deadline until) {
  if (!is_alive() || PQenterPipelineMode(connection_.get()) != 1)
    throw_lost("running '" + begin_of(requests.front().sql) + "'");
  const std::vector<Command> commands = send(requests);
  flush(until);
  return receive(commands, until);
}

std::vector<Connection::Command> Connection::send(std::span<const Request> requests) {
  std::vector<Command> commands;
  for (const Request& request : requests)
    send_one(request, commands);
  if (PQpipelineSync(connection_.get()) != 1)
    throw_lost("sending statements");
  return commands;
}

/// Of the prepared statement, which is prepared on the way if it is new.
const std::string& Connection::name_of(const Request& request, std::vector<Command>& commands) {
  static_assert(std::is_same_v<unsigned, Oid>);
  const auto known = statements_.find(request.sql);
  if (known != statements_.end())
    return known->second;
  const auto added = statements_.emplace(std::string(request.sql), name_by(request.sql)).first;
  const Parameters& parameters = request.parameters;
  if (PQsendPrepare(connection_.get(), added->second.c_str(), added->first.c_str(),
                    static_cast<int>(parameters.size()), parameters.types().data()) != 1)
    throw_lost("preparing '" + begin_of(request.sql) + "'");
  commands.push_back({request.sql, true});
  return added->second;
}

void Connection::send_one(const Request& request, std::vector<Command>& commands) {
  const Parameters& parameters = request.parameters;
  const auto count = static_cast<int>(parameters.size());
  std::vector<const char*> values(parameters.size());
  std::vector<int> lengths(parameters.size());
  const std::vector<int> formats(parameters.size(), kBinary);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    values[i] = parameters.value(i);
    lengths[i] = parameters.length(i);
  }
  const int sent =
      keeps_statements()
          ? PQsendQueryPrepared(connection_.get(), name_of(request, commands).c_str(), count,
                                values.data(), lengths.data(), formats.data(), kBinary)
          : PQsendQueryParams(connection_.get(), std::string(request.sql).c_str(), count,
                              parameters.types().data(), values.data(), lengths.data(),
                              formats.data(), kBinary);
  if (sent != 1)
    throw_lost("sending '" + begin_of(request.sql) + "'");
  commands.push_back({request.sql, false});
}

/// Reads up to the end of the pipeline, whatever fails in it, so that the next one can begin.
std::vector<Rows> Connection::receive(const std::vector<Command>& commands, Deadline until) {
  std::vector<Rows> rows;
  std::optional<PostgresError> failed;
  for (const Command& command : commands) {
    Rows answer(next_result(until));
    const ExecStatusType status = PQresultStatus(answer.get());
    const bool is_done = status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK;
    if (status == PGRES_FATAL_ERROR && !failed)
      failed = error_of(answer.get(), command.sql);
    if (failed && failed->kind() == ErrorKind::Forgotten && options_.is_pooled != nullptr)
      *options_.is_pooled = true;
    if (failed && failed->kind() == ErrorKind::Lost) {
      abandon();
      throw PostgresError(*failed);
    }
    if (command.is_preparation && !is_done)
      statements_.erase(std::string(command.sql));
    if (!command.is_preparation && is_done)
      rows.push_back(std::move(answer));
    while (pg_result* const more = next_result(until))  // none: one answer, then a null one
      PQclear(more);
  }
  PQclear(next_result(until));  // of the end of the pipeline
  if (PQexitPipelineMode(connection_.get()) != 1)
    throw_lost("leaving pipeline mode");
  if (failed)
    throw PostgresError(*failed);
  return rows;
}

pg_result* Connection::next_result(Deadline until) {
  while (PQisBusy(connection_.get()) == 1) {
    wait(POLLIN, until);
    if (PQconsumeInput(connection_.get()) != 1)
      throw_lost("waiting for an answer");
  }
  pg_result* const result = PQgetResult(connection_.get());
  if (result == nullptr && PQstatus(connection_.get()) != CONNECTION_OK)
    throw_lost("waiting for an answer");
  return result;
}

void Connection::flush(Deadline until) {
  int left = 0;
  while ((left = PQflush(connection_.get())) == 1) {
    // The server may have to get rid of answers before it takes more.
    wait(POLLIN | POLLOUT, until);
    if (PQconsumeInput(connection_.get()) != 1)
      throw_lost("sending statements");
  }
  if (left < 0)
    throw_lost("sending statements");
}

void Connection::wait(short events, Deadline until) {
  std::array<pollfd, 2> waited = {
      pollfd{.fd = PQsocket(connection_.get()), .events = events, .revents = 0},
      pollfd{.fd = -1, .events = POLLIN, .revents = 0}};
  if (options_.interrupt != nullptr)
    waited[1].fd = options_.interrupt->descriptor();
  int left_ms = -1;
  if (until) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(*until - std::chrono::steady_clock::now());
    left_ms = static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0));
  }
  const int ready = poll(waited.data(), waited.size(), left_ms);
  if (ready < 0 && errno == EINTR)
    return;
  if (ready > 0 && waited[1].revents == 0)
    return;
  const std::string why =
      ready == 0 ? "no answer within " + std::to_string(options_.patience.count() / 1000) + " s"
                 : "the server is stopping";
  abandon();
  throw PostgresError("", where_.description() + ": " + why);
}

void Connection::throw_lost(const std::string& doing) {
  const std::string why =
      connection_ ? one_line(PQerrorMessage(connection_.get())) : "the connection was given up";
  abandon();
  throw PostgresError("", where_.without_secrets(where_.description() + ": " + doing + ": " +
                                                 (why.empty() ? "the connection is lost" : why)));
}

PostgresError Connection::error_of(const pg_result* result, std::string_view sql) {
  std::string what = field(result, PG_DIAG_MESSAGE_PRIMARY);
  if (what.empty())
    what = one_line(PQresultErrorMessage(result));
  if (const std::string detail = field(result, PG_DIAG_MESSAGE_DETAIL); !detail.empty())
    what += " (" + detail + ")";
  const std::string sqlstate = field(result, PG_DIAG_SQLSTATE);
  return PostgresError(
      sqlstate, where_.without_secrets(where_.description() + ": " + what +
                                       (sqlstate.empty() ? "" : " [" + sqlstate + "]") + " in '" +
                                       begin_of(sql) + "'"));
}

}  // namespace kinship::store::postgres
