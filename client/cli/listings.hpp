#pragma once

#include <iosfwd>
#include <string>

#include "client/cli/admin_rows.hpp"
#include "client/link/client.hpp"

/// Commands that list or show the contents of a server's store. Each prints for people, or one JSON
/// document with `json`, and returns an exit code.
namespace kinship::cli {

int show_status(link::Client& server, bool json, std::ostream& out, std::ostream& err);

int list_robots(link::Client& server, const ListOptions& options, std::ostream& out,
                std::ostream& err);
int list_tasks(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err);
int list_paths(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err);
int list_distributions(link::Client& server, const ListOptions& options, std::ostream& out,
                       std::ostream& err);
int list_jobs(link::Client& server, const ListOptions& options, std::ostream& out,
              std::ostream& err);
int list_backups(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err);
/// `status --clients`: the use that each client makes of the server, the busiest first.
int list_clients(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err);

/// \param name  a label, or the beginning of a digest.
int show_robot(link::Client& server, const std::string& name, bool json, std::ostream& out,
               std::ostream& err);
int show_task(link::Client& server, const std::string& task, bool json, std::ostream& out,
              std::ostream& err);
/// \param id  a report UUID.
int show_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
              std::ostream& err);
/// \param id  the beginning of a distribution's id.
int show_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                      std::ostream& err);

}  // namespace kinship::cli
