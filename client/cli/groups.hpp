#pragma once

#include "client/cli/session.hpp"

/// The command line of each noun.
namespace kinship::cli {

void add_server_commands(CLI::App& app, Session& session);  ///< status, backup, watch, audit
void add_jobs(CLI::App& app, Session& session);
void add_robots(CLI::App& app, Session& session);
void add_problems(CLI::App& app, Session& session);
void add_tasks(CLI::App& app, Session& session);
void add_paths(CLI::App& app, Session& session);
void add_distributions(CLI::App& app, Session& session);
void add_configurations(CLI::App& app, Session& session);
void add_completion(CLI::App& app, Session& session);  ///< completion and candidates

}  // namespace kinship::cli
