#include "server/app/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <ostream>
#include <thread>

#include "proto/dds/participant.hpp"

namespace kinship::app {
namespace {

constexpr const char* kDescription =
    "kinshipd: keeps the planning experience of a fleet of robots and makes it of use to others";

constexpr const char* kFooter =
    R"(Prints 'ready domain=N store=FILE' when it serves; the log goes to stderr. SIGTERM, SIGINT and
SIGHUP end it after what was reported is durable. Exit codes: 0 done, 1 failed, 2 wrong usage.

Examples:
  kinshipd                                       default store, domain 0, loopback
  kinshipd --store /var/lib/kinship/fleet.db --domain 7 --workers 4
  kinshipd --config /etc/kinship/kinshipd.ini    lines like: store=/var/lib/kinship/fleet.db)";

std::size_t default_workers() {
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

}  // namespace

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

std::variant<ServerOptions, int> parse_arguments(int argc, const char* const* argv,
                                                 std::ostream& out, std::ostream& err) {
  constexpr std::size_t kMostWorkers = 256;
  ServerOptions options;
  options.store = default_store();
  options.workers = default_workers();

  CLI::App app(kDescription, "kinshipd");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("kinshipd ") + KINSHIP_VERSION);
  app.set_config("--config", "", "Read options from an INI or TOML file")->check(CLI::ExistingFile);
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.add_option("--store", options.store, "SQLite file; made if there is none")
      ->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain")
      ->envname("KINSHIP_DOMAIN")
      ->check(CLI::Range(std::uint32_t{0}, dds::kMaxDomain))
      ->capture_default_str();
  app.add_option("--interface", options.network_interface,
                 "Network interface to serve, e.g. eth0; default: loopback, this machine only");
  app.add_option("--workers", options.workers, "Threads that transfer and fit, at low priority")
      ->check(CLI::Range(std::size_t{1}, kMostWorkers))
      ->capture_default_str();
  app.add_option("--log-level", options.log_level, "What goes to stderr")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error, out, err) == 0 ? kDone : kWrongUsage;
  }
  if (options.store.empty() && app.count("--store") > 0) {
    err << "kinshipd: --store is empty; it needs a file\n";
    return kWrongUsage;
  }
  if (options.store.empty()) {
    err << "kinshipd: neither XDG_STATE_HOME nor HOME is set; say where with --store FILE\n";
    return kWrongUsage;
  }
  return options;
}

}  // namespace kinship::app
