#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/types/exit_code.hpp"
#include "server/app/check_sites_options.hpp"
#include "server/app/migrate_store_options.hpp"
#include "server/app/secure_options.hpp"

namespace kinship::app {

/// Quotas of one client, 0: no limit (server/quotas, ServiceOptions).
struct ClientQuotaOptions {
  double attempts_per_s = 1000;
  double mb_per_s = 16;
  std::size_t waiting = 256;
  std::size_t leases = 256;
  std::size_t fits = 64;
  double robots_per_day = 2000;
  double tasks_per_day = 2000;
  double stored_mb_per_day = 16'000;
};

/// Options of kinshipd as a server.
struct ServerOptions {
  std::filesystem::path store;       ///< of SQLite, or the URL of a PostgreSQL database
  bool new_store = false;            ///< of SQLite: begin one beside what a lost one left
  bool require_synchronous = false;  ///< of a database: acknowledge only data that a standby has
  bool primary_only = false;         ///< of a database: fits read no standby
  std::uint32_t domain = 0;
  std::string network_interface;  ///< empty: loopback
  /// Folder of certificates and records of clients (kinshipd secure init); empty: no security.
  std::filesystem::path security;
  bool insecure = false;  ///< may serve other hosts without security
  /// Of the token that changes then need; empty: beside the store.
  std::filesystem::path token_file;
  std::size_t workers = 1;              ///< threads that transfer and fit
  std::filesystem::path backup_folder;  ///< empty: the folder of the store
  std::size_t fit_memory_mb = 2048;     ///< of all fits together, at most
  int fit_niceness = 10;                ///< of these threads, 0 to 19
  /// Mean fraction of one processor that rehearsing takes, 0 to 1; 0: no rehearsals.
  double rehearsal_fraction = 0.1;
  std::uint64_t free_space_watermark_mb = 64;  ///< with less free, no report is taken; 0: no limit
  std::uint64_t ballast_mb = 16;               ///< kept beside the store for a full disk; 0: none
  /// Paths that a robot and task keep; 0: all.
  std::uint64_t max_paths_per_pair = 20'000;
  std::uint64_t stored_distributions_mb = 1024;  ///< distributions that the store keeps; 0: all
  std::uint64_t stored_meshes_mb = 256;          ///< of robots, that the store keeps; 0: none
  std::uint64_t search_records_mb = 256;         ///< that the store keeps; 0: none
  std::uint32_t search_record_days = 90;         ///< 0: no limit
  std::size_t distribution_memory_mb = 128;      ///< distributions in memory
  std::size_t path_memory_mb = 64;               ///< pose paths in memory
  std::uint64_t max_wal_mb = 512;                ///< with more kept by readings, no report is taken
  /// Rate at which the store's file is scanned for damage, MB per second; 0: no scan.
  double scrub_mb_per_s = 4;
  ClientQuotaOptions client;
  std::string upstream;                     ///< URL of the memory above this site; empty: none
  std::vector<std::string> upstream_tasks;  ///< patterns of tasks that always come down from it
  std::string metrics;                      ///< address and port to serve metrics at; empty: none
  std::vector<std::string> metrics_hosts;   ///< names by which they may be asked for
  std::string console;         ///< address and port to serve the live console at; empty: none
  bool console_admin = false;  ///< it may change something
  std::vector<std::string> console_hosts;  ///< names by which it may be asked for
  bool ros2 = false;                       ///< serve ROS 2 nodes, too
  std::uint32_t ros2_domain = 0;           ///< their ROS_DOMAIN_ID
  std::filesystem::path ros2_enclave;      ///< of SROS 2; empty: without security
  std::string log_level = "info";
};

enum class OfflineVerb { Check, Backup, Restore, Repair, Migrate };

/// A verb on a store that no server has open, and its options.
struct OfflineOptions {
  OfflineVerb verb = OfflineVerb::Check;
  std::filesystem::path store;
  std::filesystem::path file;  ///< the backup to make or to restore
  bool json = false;
};

using Options = std::variant<ServerOptions, OfflineOptions, MigrateStoreOptions, CheckSitesOptions,
                             SecureOptions, int>;

/// Options from the command line, then from the file of --config; the domain then from the
/// environment (KINSHIP_DOMAIN).
/// \return the options, or an exit code after help, the configuration or a message was written.
Options parse_arguments(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

/// A warning, for people, of the risks of serving without security; empty if only this machine is
/// served or security is on.
std::string insecurity_of(const ServerOptions& options);

/// The file of the token that changes need; empty if they need none: with security, or if only this
/// machine is served.
std::filesystem::path token_file_of(const ServerOptions& options);

/// experience.db under $XDG_STATE_HOME/kinship, or under ~/.local/state/kinship. Empty if neither
/// variable gives a folder.
std::filesystem::path default_store();

}  // namespace kinship::app
