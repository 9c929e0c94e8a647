#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// PostgreSQL's programs as the system has them, and as whom they may run: PostgreSQL refuses root.
namespace kinship::test {

/// What is missing to run a cluster here, in words for GTEST_SKIP; empty: nothing.
std::string missing_postgres();
/// The same of pgbouncer.
std::string missing_pgbouncer();

/// \param name  of a program of PostgreSQL's server, "initdb". \return its path.
std::string postgres_program(const std::string& name);
std::string pgbouncer_program();

/// The command that runs a command as user postgres if we are root, else as ourselves; it gets
/// SIGQUIT when the thread that started it ends, so that nothing stays behind a test that died.
std::vector<std::string> as_postgres(std::vector<std::string> command);
/// Gives a folder to whom as_postgres() runs.
void give_to_postgres(const std::filesystem::path& folder);

}  // namespace kinship::test
