#include "tests/support/postgres_cluster.hpp"
#include "tests/support/places.hpp"

#include <sys/ipc.h>
#include <sys/shm.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <stdexcept>

#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"

namespace kinship::test {
namespace {

constexpr const char* kPort = "5432";  // part of the socket's name

/// Small and quick; what a crash of processes alone can lose does not depend on fsync.
constexpr const char* kSettings = R"(
listen_addresses = ''
fsync = off
max_connections = 400
shared_buffers = 32MB
dynamic_shared_memory_type = mmap
max_wal_size = 256MB
min_wal_size = 16MB
wal_level = replica
wal_log_hints = on
wal_keep_size = 64MB
wal_retrieve_retry_interval = 50ms
max_wal_senders = 10
hot_standby = on
jit = off
)";

/// initdb, which takes longer than all that most tests do: so its outcome is kept beside the tests'
/// programs, and copied. All clusters have one system identifier then.
void make_cluster(const std::filesystem::path& data, const std::filesystem::path& log) {
  const std::filesystem::path version =
      std::filesystem::path(postgres_program("initdb")).parent_path().parent_path().filename();
  const std::filesystem::path pattern =
      test::bin_dir() + "/../tests/postgresql-" + version.string() + "-cluster";
  const auto copy = [&](const std::filesystem::path& from, const std::filesystem::path& to) {
    run_to_end({"/bin/cp", "--archive", "--reflink=auto", from, to}, log);
  };
  if (std::filesystem::exists(pattern)) {
    copy(pattern, data);
    return;
  }
  run_to_end(as_postgres({postgres_program("initdb"), "--pgdata", data, "--username=kinship",
                          "--auth=trust", "--encoding=UTF8", "--locale=C", "--wal-segsize=1",
                          "--no-sync", "--no-instructions"}),
             log);
  const std::filesystem::path copied = pattern.string() + "-" + std::to_string(getpid());
  copy(data, copied);
  std::error_code another_was_first;
  std::filesystem::rename(copied, pattern, another_was_first);
  if (another_was_first)
    std::filesystem::remove_all(copied);
}

std::string quoted(const std::string& value, char quote) {
  std::string text(1, quote);
  for (const char c : value)
    text += c == quote ? std::string(2, c) : std::string(1, c);
  return text + quote;
}

void append_lines(const std::filesystem::path& file, const std::vector<std::string>& lines) {
  std::ofstream stream(file, std::ios::app);
  for (const std::string& line : lines)
    stream << line << '\n';
  if (!stream.flush())
    throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

PostgresCluster::PostgresCluster(const Options& options)
    : name_(options.name), folder_(options.root) {
  give_to_postgres(folder_.path());
  make_cluster(data(), log());
  append_lines(data() / "postgresql.conf", {kSettings});
  append_lines(data() / "postgresql.conf", options.settings);
  start();
}

PostgresCluster::PostgresCluster(const PostgresCluster& primary, const Options& options)
    : name_(options.name), folder_(options.root) {
  give_to_postgres(folder_.path());
  run_to_end(as_postgres({postgres_program("pg_basebackup"), "--pgdata", data(), "--host",
                          primary.folder(), "--port", kPort, "--username=kinship",
                          "--checkpoint=fast", "--wal-method=stream", "--no-sync"}),
             log());
  append_lines(data() / "postgresql.conf", options.settings);
  become_standby_of(primary);
  start();
  wait_until_streaming_from(primary);
}

PostgresCluster::~PostgresCluster() {
  if (is_running())
    kill();
}

std::string PostgresCluster::url(const std::string& database) const {
  return "postgresql://kinship@/" + database + "?host=" + folder().string() + "&port=" + kPort;
}

std::string PostgresCluster::query(const std::string& sql, const std::string& database) const {
  return query_postgres(url(database), sql);
}

std::string PostgresCluster::create_database(const std::string& database,
                                             const std::string& pattern) const {
  query("CREATE DATABASE " + quoted(database, '"') + " TEMPLATE " + quoted(pattern, '"'));
  return url(database);
}

void PostgresCluster::drop_database(const std::string& database) const {
  query("DROP DATABASE IF EXISTS " + quoted(database, '"') + " WITH (FORCE)");
}

void PostgresCluster::set(const std::string& setting, const std::string& value) const {
  query("ALTER SYSTEM SET " + setting + " = " + quoted(value, '\''));
  query("SELECT pg_reload_conf()");
  wait_until_true(url(), "SELECT current_setting('" + setting + "') = " + quoted(value, '\''));
}

void PostgresCluster::start() {
  std::vector<std::string> command = {postgres_program("postgres"),
                                      "-D",
                                      data(),
                                      "-c",
                                      "unix_socket_directories=" + folder().string(),
                                      "-c",
                                      "cluster_name=" + name_};
  if (!primary_conninfo_.empty())
    command.insert(command.end(), {"-c", "primary_conninfo=" + primary_conninfo_});
  server_ =
      std::make_unique<NotifyingProcess>(as_postgres(std::move(command)), folder_ / "ready", log());
  server_->wait_until_ready();
}

void PostgresCluster::stop() {
  server_->signal(SIGINT);
  if (const int code = server_->wait(); code != 0)
    throw std::runtime_error(name_ + " ended with " + std::to_string(code) + ", see its log");
}

void PostgresCluster::kill() {
  server_->kill_all();
  free_shared_memory();
}

void PostgresCluster::freeze() const {
  server_->signal(SIGSTOP);
  for (const pid_t child : server_->children())
    ::kill(child, SIGSTOP);
}

void PostgresCluster::thaw() const {
  for (const pid_t child : server_->children())
    ::kill(child, SIGCONT);
  server_->signal(SIGCONT);
}

void PostgresCluster::promote() {
  server_->forget_readiness();
  append_lines(data() / "promote", {});  // as pg_ctl does
  server_->signal(SIGUSR1);
  server_->wait_until_ready();
  primary_conninfo_.clear();
}

void PostgresCluster::freeze_receiver() const {
  for (const pid_t receiver : server_->children("walreceiver"))
    ::kill(receiver, SIGSTOP);
}

void PostgresCluster::thaw_receiver() const {
  for (const pid_t receiver : server_->children("walreceiver"))
    ::kill(receiver, SIGCONT);
}

void PostgresCluster::kill_receiver() {
  const std::vector<pid_t> receivers = server_->children("walreceiver");
  if (receivers.empty())
    return;
  server_->forget_readiness();
  for (const pid_t receiver : receivers)
    ::kill(receiver, SIGKILL);
  server_->wait_until_ready();  // it starts anew, as after the crash of any of its processes
}

bool PostgresCluster::has_receiver() const { return !server_->children("walreceiver").empty(); }

void PostgresCluster::rewind_and_follow(const PostgresCluster& primary) {
  // It learns from the control file which history is the longer one: not before a checkpoint.
  primary.query("CHECKPOINT");
  run_to_end(
      as_postgres(
          {postgres_program("pg_rewind"), "--target-pgdata", data(), "--source-server",
           "host=" + primary.folder().string() + " port=" + kPort + " user=kinship dbname=postgres",
           "--no-sync"}),
      log());
  become_standby_of(primary);
  start();
  wait_until_streaming_from(primary);
}

void PostgresCluster::become_standby_of(const PostgresCluster& primary) {
  primary_conninfo_ = "host=" + primary.folder().string() + " port=" + kPort + " user=kinship";
  append_lines(data() / "standby.signal", {});
}

void PostgresCluster::wait_until_streaming_from(const PostgresCluster& primary) const {
  wait_until_true(primary.url(),
                  "SELECT EXISTS (SELECT FROM pg_stat_replication WHERE application_name = " +
                      quoted(name_, '\'') +
                      " AND state = 'streaming' AND (sync_state <> 'async' OR " +
                      "current_setting('synchronous_standby_names') !~ application_name))");
}

/// A killed server leaves its mark in System V's shared memory, which would stay for ever.
void PostgresCluster::free_shared_memory() const {
  constexpr int kLineOfKey = 7;
  std::ifstream lines(data() / "postmaster.pid");
  std::string line;
  for (int i = 0; i < kLineOfKey; ++i)
    std::getline(lines, line);
  const std::size_t blank = line.find_last_of(' ');
  if (!lines || blank == std::string::npos)
    return;
  shmctl(std::stoi(line.substr(blank + 1)), IPC_RMID, nullptr);
}

std::string url_of_either(const PostgresCluster& one, const PostgresCluster& other,
                          const std::string& database) {
  return "postgresql://kinship@/" + database + "?host=" + one.folder().string() + "," +
         other.folder().string() + "&port=" + kPort + "," + kPort +
         "&target_session_attrs=read-write";
}

void lose_primary(PostgresCluster& primary, PostgresCluster& standby) {
  standby.freeze_receiver();
  primary.kill();
  standby.kill_receiver();
}

void wait_until_replayed(const PostgresCluster& primary, const PostgresCluster& standby) {
  const std::string written = primary.query("SELECT pg_current_wal_flush_lsn()");
  wait_until_true(standby.url(), "SELECT pg_last_wal_replay_lsn() >= '" + written + "'");
}

}  // namespace kinship::test
