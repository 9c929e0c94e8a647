#include "tests/support/postgres_programs.hpp"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>

namespace kinship::test {
namespace {

constexpr const char* kPostgresFolder = "/usr/lib/postgresql";
constexpr const char* kBouncer = "/usr/sbin/pgbouncer";
constexpr const char* kSetpriv = "/usr/bin/setpriv";
constexpr const char* kUser = "postgres";

/// Where Debian has the programs of the newest version that is installed (15 in Debian 12, 17 in
/// 13); its wrappers in /usr/bin are for clusters of the system.
std::string newest_folder() {
  long newest = 0;
  std::error_code missing;
  for (std::filesystem::directory_iterator entry(kPostgresFolder, missing), end;
       !missing && entry != end; entry.increment(missing))
    if (std::filesystem::exists(entry->path() / "bin/initdb", missing))
      newest = std::max(newest, std::strtol(entry->path().filename().c_str(), nullptr, 10));
  return std::string(kPostgresFolder) + "/" + std::to_string(newest) + "/bin";
}

bool may_run(const std::string& program) { return access(program.c_str(), X_OK) == 0; }

}  // namespace

std::string missing_postgres() {
  for (const char* const name : {"initdb", "postgres", "pg_basebackup", "pg_rewind"})
    if (!may_run(postgres_program(name)))
      return "no " + postgres_program(name) + " here (Debian package postgresql)";
  if (!may_run(kSetpriv))
    return std::string("no ") + kSetpriv + " here (Debian package util-linux)";
  if (geteuid() == 0 && getpwnam(kUser) == nullptr)  // NOLINT(concurrency-mt-unsafe)
    return "PostgreSQL does not run as root, and there is no user postgres";
  return "";
}

std::string missing_pgbouncer() {
  return may_run(kBouncer) ? missing_postgres()
                           : std::string("no ") + kBouncer + " here (Debian package pgbouncer)";
}

std::string postgres_program(const std::string& name) {
  static const std::string kFolder = newest_folder();
  return kFolder + "/" + name;
}

std::string pgbouncer_program() { return kBouncer; }

std::vector<std::string> as_postgres(std::vector<std::string> command) {
  std::vector<std::string> words = {kSetpriv};
  if (geteuid() == 0)
    for (const char* const option : {"--reuid=postgres", "--regid=postgres", "--init-groups"})
      words.emplace_back(option);
  words.emplace_back("--pdeathsig=QUIT");
  words.emplace_back("--");
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

void give_to_postgres(const std::filesystem::path& folder) {
  if (geteuid() != 0)
    return;
  const passwd* const user = getpwnam(kUser);  // NOLINT(concurrency-mt-unsafe)
  if (user == nullptr || chown(folder.c_str(), user->pw_uid, user->pw_gid) != 0)
    throw std::system_error(errno, std::system_category(), "cannot give away " + folder.string());
}

}  // namespace kinship::test
