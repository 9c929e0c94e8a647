#include "server/app/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "proto/dds/participant.hpp"
#include "proto/manual/manual.hpp"
#include "proto/manual/suggestion.hpp"
#include "proto/types/nearest_name.hpp"
#include "server/app/configuration_text.hpp"
#include "server/app/database_url.hpp"
#include "server/app/password.hpp"
#include "server/app/port_options.hpp"

namespace kinship::app {
namespace {

constexpr const char* kLoopback = "lo";

constexpr const char* kDescription =
    "kinshipd: keeps the planning experience of a fleet of robots and makes it of use to others";

constexpr const char* kFooter =
    R"(Prints 'ready domain=N store=FILE' when it serves; the log goes to stderr. SIGTERM, SIGINT and
SIGHUP end it after what was reported is durable. With a verb it does that to the store and ends: no
server may have the store open. Exit codes: 0 done, 1 failed or damage found, 2 wrong usage, 3 no such file.

Examples:
  kinshipd                                       default store, domain 0, loopback
  kinshipd --store /var/lib/kinship/fleet.db --domain 7 --workers 4
  kinshipd --store 'postgresql://kinship@db1,db2/fleet' --require-synchronous   one of several servers
  kinshipd --config /etc/kinship/kinshipd.toml   lines like: store = "/var/lib/kinship/fleet.db"
  kinshipd --interface eth0 --security /etc/kinship/security      other hosts, with certificates
  kinshipd --metrics 127.0.0.1:9464              what Prometheus reads, at http://127.0.0.1:9464/metrics
  kinshipd --console 127.0.0.1:9480              pages for a browser; kinship console prints the link
  kinshipd --upstream 'postgresql://memory.example/kinship?sslmode=verify-full'    one of several sites
  kinshipd --print-config > kinshipd.toml        all options, their values and where these are from
  kinshipd check --store fleet.db                reads all of it; --json for programs
  kinshipd backup --store fleet.db copy.db       (of a running server: kinship backup)
  kinshipd restore --store fleet.db copy.db      keeps the old one as fleet.db.replaced-<time>
  kinshipd repair --store fleet.db               what can be read of a damaged store, as a new one
  kinshipd migrate-store --from fleet.db --to 'postgresql://kinship@db1/fleet'    each row, resumable
  kinshipd secure init DIR                       certificates for the fleet; kinshipd secure --help)";

/// The end of a verb's help, before its example.
constexpr const char* kVerbFooter =
    R"(No server may have the store open. Exit codes: 0 done, 1 failed or damage found, 2 wrong usage,
3 no such file.

Example:
  )";

std::size_t default_workers() {
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// Takes numbers from 0 to `highest`; CLI::Range lets other texts pass.
CLI::Validator is_number_up_to(int highest) {
  const std::string range = std::to_string(highest);
  return {[highest, range](std::string& text) {
            double number = 0;
            return CLI::detail::lexical_cast(text, number) && number >= 0 && number <= highest
                       ? std::string()
                       : "'" + text + "' is not a number from 0 to " + range;
          },
          "FLOAT in [0 - " + range + "]"};
}

CLI::Validator is_upstream() {
  return {[](std::string& text) {
            return is_database_url(text) ? std::string()
                                         : "a memory above is a PostgreSQL database: "
                                           "postgresql://HOST/DATABASE";
          },
          ""};
}

/// The memory above a site.
void add_upstream_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--upstream", options.upstream,
                 "Memory above this site: reports go up to it, and the experience of other sites "
                 "comes down, whenever it can be reached; default: none")
      ->check(is_upstream())
      ->type_name("URL");
  app.add_option("--upstream-tasks", options.upstream_tasks,
                 "Tasks whose experience always comes down, e.g. 'pick_*'; those that robots here "
                 "fetch for do so anyway")
      ->type_name("PATTERN")
      ->needs("--upstream");
}

/// The store's use of its disk.
void add_disk_options(CLI::App& app, ServerOptions& options) {
  constexpr std::uint64_t kMaxMegabytes = std::uint64_t{1} << 30U;  // 1 PB
  app.add_option("--free-space-watermark-mb", options.free_space_watermark_mb,
                 "While the store's file system has less free, reports are answered 'try again'; "
                 "0: no limit")
      ->check(CLI::Range(std::uint64_t{0}, kMaxMegabytes))
      ->capture_default_str();
  app.add_option("--ballast-mb", options.ballast_mb,
                 "Size of FILE.ballast, given up on a full disk so that the store can still be "
                 "brought into order; 0: none")
      ->check(CLI::Range(std::uint64_t{0}, kMaxMegabytes))
      ->capture_default_str();
  app.add_option("--max-wal-mb", options.max_wal_mb,
                 "While long readings keep more than this in FILE-wal, reports are answered 'try "
                 "again'")
      ->check(CLI::Range(std::uint64_t{1}, kMaxMegabytes))
      ->capture_default_str();
}

/// Retention of the fleet's experience and of its distributions.
void add_retention_options(CLI::App& app, ServerOptions& options) {
  constexpr std::uint64_t kMaxPaths = 1'000'000'000;
  constexpr std::uint64_t kMaxMegabytes = std::uint64_t{1} << 24U;
  app.add_option("--max-paths-per-pair", options.max_paths_per_pair,
                 "Paths that a robot and task keep: of more, a random sample; their attempts stay "
                 "recorded; 0: all")
      ->check(CLI::Range(std::uint64_t{0}, kMaxPaths))
      ->capture_default_str();
  app.add_option("--stored-distributions-mb", options.stored_distributions_mb,
                 "Distributions that the store keeps; those not used for longest go first; 0: all")
      ->check(CLI::Range(std::uint64_t{0}, kMaxMegabytes))
      ->capture_default_str();
  app.add_option("--stored-meshes-mb", options.stored_meshes_mb,
                 "Meshes of robots that the store keeps, each once for all; beyond that solids "
                 "around them serve; 0: none is taken")
      ->check(CLI::Range(std::uint64_t{0}, kMaxMegabytes))
      ->capture_default_str();
  constexpr std::uint32_t kMaxDays = 100'000;
  app.add_option("--search-records-mb", options.search_records_mb,
                 "Search records of attempts that the store keeps, the oldest go first; 0: none is "
                 "kept")
      ->check(CLI::Range(std::uint64_t{0}, kMaxMegabytes))
      ->capture_default_str();
  app.add_option("--search-record-days", options.search_record_days,
                 "Days that search records are kept; the attempts stay; 0: no limit")
      ->check(CLI::Range(std::uint32_t{0}, kMaxDays))
      ->capture_default_str();
  app.add_option("--distribution-memory-mb", options.distribution_memory_mb,
                 "Distributions in memory; those not used for longest go first")
      ->check(CLI::Range(std::uint64_t{1}, kMaxMegabytes))
      ->capture_default_str();
  app.add_option("--path-memory-mb", options.path_memory_mb,
                 "Ways of paths in memory, for the experience of tasks; the task not asked for "
                 "longest goes first")
      ->check(CLI::Range(std::uint64_t{1}, kMaxMegabytes))
      ->capture_default_str();
}

/// Quotas of one client; requests beyond them are answered busy, with a time.
void add_client_options(CLI::App& app, ClientQuotaOptions& client) {
  constexpr int kMaxPerSecond = 1'000'000, kMaxPerDay = 1'000'000'000, kMaxAtATime = 1'000'000;
  const auto add = [&app](const char* name, auto& value, const char* description, int highest) {
    app.add_option(name, value, description)
        ->check(is_number_up_to(highest))
        ->capture_default_str();
  };
  add("--client-attempts-per-s", client.attempts_per_s,
      "Attempts that one client may report, a second, and ten times as many at once; 0: no limit",
      kMaxPerSecond);
  add("--client-mb-per-s", client.mb_per_s,
      "MB that one client may send and be sent, a second, and ten times as many at once; 0: no "
      "limit",
      kMaxPerSecond);
  add("--client-waiting", client.waiting,
      "Fetches of one client that may wait, and as many requests for the store; 0: no limit",
      kMaxAtATime);
  add("--client-leases", client.leases, "Distributions that one client may follow; 0: no limit",
      kMaxAtATime);
  add("--client-fits", client.fits, "Fits under way because one client asked first; 0: no limit",
      kMaxAtATime);
  add("--client-robots-per-day", client.robots_per_day,
      "Robots that one client may register, of those not known, a day; 0: no limit", kMaxPerDay);
  add("--client-tasks-per-day", client.tasks_per_day,
      "Tasks that one client may report the first attempt of, a day; 0: no limit", kMaxPerDay);
  add("--client-stored-mb-per-day", client.stored_mb_per_day,
      "MB of paths of one client that are stored, a day; 0: no limit", kMaxPerDay);
}

/// The store that is served, the network and the access to it.
void add_place_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--store", options.store,
                 "SQLite file, made with its folder if there is none; or a PostgreSQL database, "
                 "which several servers may share: postgresql://USER@HOST:PORT/DATABASE")
      ->type_name("FILE|URL")
      ->capture_default_str();
  app.add_flag(
         "--new-store", options.new_store,
         "Begin a new SQLite file though files of one that is gone are there: its -wal, -shm and "
         "-journal are set aside as FILE.replaced-<time>.*, its high-water mark is removed; "
         "refused if there is a file")
      ->configurable(false);
  app.add_flag(
      "--require-synchronous", options.require_synchronous,
      "Of a PostgreSQL database: while it has no synchronous standby, reports are answered "
      "'try again'");
  app.add_flag("--primary-only", options.primary_only,
               "Of a PostgreSQL database: fits read from its primary too; default: from a standby "
               "that --store names, while that one is as new as they want");
  app.add_option("--domain", options.domain, "DDS domain")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(std::uint32_t{0}, dds::kMaxDomain))
      ->capture_default_str();
  app.add_option("--interface", options.network_interface,
                 "Network interface to serve, e.g. eth0; default: loopback, this machine only");
  app.add_option("--security", options.security,
                 "Security folder, made by 'kinshipd secure init': only who has a certificate of "
                 "it is heard; default: none")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  app.add_flag("--insecure", options.insecure,
               "Serve other hosts without --security: whoever reaches the ports may read, report "
               "and register; what changes or removes needs the token of --token-file");
  app.add_option(
         "--token-file", options.token_file,
         "Of --insecure: file with the token that 'kinship --token FILE' shows to change or "
         "remove, made with mode 0600 if there is none; default: STORE.token")
      ->type_name("FILE");
}

/// Options for serving, each also in a file that --config names.
void add_server_options(CLI::App& app, ServerOptions& options) {
  constexpr std::size_t kMaxWorkers = 256;
  constexpr int kMaxScrubMbPerS = 1000;
  constexpr std::size_t kMinFitMemory_mb = 16, kMaxFitMemory_mb = std::size_t{1} << 24U;
  app.set_config("--config", "", "Read options from an INI or TOML file")->check(CLI::ExistingFile);
  app.allow_config_extras(CLI::config_extras_mode::error);
  add_place_options(app, options);
  app.add_option("--workers", options.workers, "Threads that transfer and fit, at low priority")
      ->check(CLI::Range(std::size_t{1}, kMaxWorkers))
      ->capture_default_str();
  app.add_option("--backup-folder", options.backup_folder,
                 "Folder that 'kinship backup' may write into; default: that of the store, none of "
                 "a database")
      ->check(CLI::ExistingDirectory);
  app.add_option("--fit-memory-mb", options.fit_memory_mb,
                 "Memory that all fits together may take; what could need more is refused")
      ->check(CLI::Range(kMinFitMemory_mb, kMaxFitMemory_mb))
      ->capture_default_str();
  app.add_option("--fit-niceness", options.fit_niceness,
                 "How far these threads step back for others on this machine")
      ->check(CLI::Range(0, 19))
      ->capture_default_str();
  app.add_option("--rehearsal-cpu", options.rehearsal_fraction,
                 "Part of one processor, in the mean, for planning recorded queries again to find "
                 "out what guides them best; 0: none")
      ->check(is_number_up_to(1))
      ->capture_default_str();
  add_disk_options(app, options);
  add_retention_options(app, options);
  add_client_options(app, options.client);
  add_upstream_options(app, options);
  app.add_option("--scrub-mb-per-s", options.scrub_mb_per_s,
                 "How fast the store is read through, again and again, in search of damage, MB a "
                 "second; 0: not at all")
      ->check(is_number_up_to(kMaxScrubMbPerS))
      ->capture_default_str();
  add_port_options(app, options);
  app.add_option("--log-level", options.log_level, "What goes to stderr")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
}

/// The verbs, as subcommands that fill `options`.
void add_verbs(CLI::App& app, OfflineOptions& options) {
  const auto add = [&](const char* name, OfflineVerb verb, const char* description,
                       const char* example) {
    CLI::App* const command = app.add_subcommand(name, description)->configurable(false);
    command->footer(std::string(kVerbFooter) + example);
    command->add_option("--store", options.store, "SQLite file")
        ->type_name("FILE")
        ->capture_default_str();
    command->callback([&options, verb] { options.verb = verb; });
    return command;
  };
  app.require_subcommand(0, 1);
  add("check", OfflineVerb::Check, "Read every row and checksum of the store",
      "kinshipd check --store fleet.db --json")
      ->add_flag("--json", options.json, "One document on stdout");
  add("backup", OfflineVerb::Backup, "Copy the store into a new file",
      "kinshipd backup --store fleet.db copy.db")
      ->add_option("FILE", options.file, "The copy; must not be there yet")
      ->type_name("FILE")
      ->required();
  add("restore", OfflineVerb::Restore, "Put a backup in the place of the store; keeps the old one",
      "kinshipd restore --store fleet.db copy.db      keeps the old one as "
      "fleet.db.replaced-<time>")
      ->add_option("FILE", options.file, "The backup; it stays as it is")
      ->type_name("FILE")
      ->required();
  add("repair", OfflineVerb::Repair,
      "Write a damaged store anew from all of it that can be read; keeps the old one",
      "kinshipd repair --store fleet.db               keeps the old one as "
      "fleet.db.replaced-<time>;\n"
      "  clients offer again what they still have, robots are registered again by their owners");
  add("migrate", OfflineVerb::Migrate, "Bring the store to this version's schema; copies it first",
      "kinshipd migrate --store fleet.db              as it was: fleet.db.backup-<version>");
}

/// The fault of the store's place; empty: none.
std::string store_fault(const CLI::App& app, const std::filesystem::path& store) {
  const bool is_offline = !app.get_subcommands().empty();
  const bool store_given = app.count("--store") > 0;
  if (is_offline && store_given)
    return "--store belongs behind the verb";
  if (!store.empty())
    return {};
  return store_given || is_offline
             ? "--store is empty; it needs a file"
             : "neither XDG_STATE_HOME nor HOME is set; say where with --store FILE";
}

/// The fault of options that do not fit the store: a file promises nothing of a database's, and a
/// memory is not above itself.
std::string store_option_fault(const ServerOptions& options) {
  if (is_database_url(options.store.string()))
    return options.upstream != options.store.string()
               ? std::string()
               : "--upstream names the same database as --store; a site has a store of its own";
  const char* const option = options.require_synchronous ? "--require-synchronous"
                             : options.primary_only      ? "--primary-only"
                                                         : nullptr;
  return option == nullptr ? std::string()
                           : std::string(option) + " is for a PostgreSQL database, but --store '" +
                                 options.store.string() + "' is a file";
}

bool replaces_configuration() {
  return std::getenv("CYCLONEDDS_URI") != nullptr;  // NOLINT(concurrency-mt-unsafe): as below
}

}  // namespace

std::string insecurity_of(const ServerOptions& options) {
  const std::filesystem::path token = token_file_of(options);
  if (token.empty())
    return {};
  const std::string served = replaces_configuration()
                                 ? "CYCLONEDDS_URI is set, which replaces the interface, and there "
                                   "is no security: whoever reaches the ports that it opens"
                                 : "interface '" + options.network_interface +
                                       "' is served without security: whoever reaches its ports";
  return served +
         " reads every robot and path, reports and registers under any name; what changes or "
         "removes needs the token in '" +
         token.string() + "' (kinship --token FILE)";
}

std::filesystem::path token_file_of(const ServerOptions& options) {
  const bool is_loopback =
      options.network_interface.empty() || options.network_interface == kLoopback;
  if (!options.security.empty() || (is_loopback && !replaces_configuration()))
    return {};
  if (!options.token_file.empty())
    return options.token_file;
  std::filesystem::path store =
      is_database_url(options.store.string()) ? default_store() : options.store;
  return store += ".token";
}

std::filesystem::path default_store() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  std::filesystem::path state = variable("XDG_STATE_HOME");
  if (!state.is_absolute()) {  // the XDG specification has relative ones ignored
    const std::filesystem::path home = variable("HOME");
    if (home.empty())
      return {};
    state = home / ".local" / "state";
  }
  return state / "kinship" / "experience.db";
}

namespace {

/// The reason not to serve with these options; empty: none.
std::string serving_fault(const ServerOptions& options) {
  for (const std::string& fault :
       {store_option_fault(options), console_fault(options), ros2_fault(options)})
    if (!fault.empty())
      return fault;
  const std::string insecurity = insecurity_of(options);
  if (insecurity.empty())
    return {};
  const bool has_place = !options.token_file.empty() || !is_database_url(options.store.string()) ||
                         !default_store().empty();
  if (options.insecure)
    return has_place
               ? ""
               : "the server's token has no place, as neither XDG_STATE_HOME nor HOME is set: "
                 "name a file for it with --token-file FILE";
  return insecurity +
         ". Make certificates ('kinshipd secure init FOLDER') and say --security FOLDER; or say "
         "--insecure if that is what you want";
}

Options parse_words(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  ServerOptions options;
  options.store = default_store();
  options.workers = default_workers();
  OfflineOptions offline;
  offline.store = options.store;

  CLI::App app(kDescription, "kinshipd");
  manual::add_manual(app, 8);
  app.footer(kFooter);
  add_server_options(app, options);
  bool print_config = false;
  app.add_flag(
         "--print-config", print_config,
         "Print the options that would serve, as a file for --config, without passwords, and end")
      ->configurable(false);
  add_verbs(app, offline);
  std::optional<SecureOptions> secure;
  add_secure_verbs(app, secure);
  std::optional<MigrateStoreOptions> move;
  add_migrate_store(app, move);
  std::optional<CheckSitesOptions> sites;
  add_check_sites(app, sites);
  try {
    manual::parse(app, argc, argv);
  } catch (const CLI::ConfigError& error) {  // says which option of it, but not where
    const std::string what = error.what();
    err << "kinshipd: --config '" << app.get_config_ptr()->as<std::string>() << "': " << what
        << suggestion(what.substr(what.find_last_of(" .") + 1), option_names(app)) << '\n';
    return kWrongUsage;
  } catch (const CLI::ParseError& error) {
    return manual::explain(app, error, out, err);
  }
  if (secure)
    return *secure;
  if (move)
    return *move;
  if (sites)
    return *sites;
  const bool is_offline = !app.get_subcommands().empty();
  if (const std::string fault = store_fault(app, is_offline ? offline.store : options.store);
      !fault.empty()) {
    err << "kinshipd: " << fault << '\n';
    return kWrongUsage;
  }
  if (print_config) {
    out << configuration_text(app, std::vector<std::string>(argv + 1, argv + argc));
    return kDone;
  }
  if (is_offline)
    return offline;
  if (const std::string fault = serving_fault(options); !fault.empty()) {
    err << "kinshipd: " << fault << '\n';
    return kWrongUsage;
  }
  return options;
}

}  // namespace

Options parse_arguments(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  std::ostringstream said;
  Options options = parse_words(argc, argv, out, said);
  err << without_passwords_of({argv, static_cast<std::size_t>(argc)}, said.str());
  return options;
}

}  // namespace kinship::app
