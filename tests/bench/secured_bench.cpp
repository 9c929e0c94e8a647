// What security costs: a distribution of 30 KB from memory and durable reports of 8 KB, in turn by
// the same clients from a kinshipd with security and from one without; and how long 100 clients,
// ten to a certificate, are without an answer after their server was killed and starts again.
//
//   secured_bench

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/link/client.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/restarted_clients.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
namespace fs = std::filesystem;

constexpr std::uint64_t kPaths = 100;
constexpr int kProcesses = 10, kClientsOfProcess = 10;

std::chrono::sys_seconds now() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// A server, and processes that are its clients: one with security hears nobody without.
struct Side {
  Side(const fs::path& folder, const fs::path& security, fs::path own_credentials)
      : credentials(std::move(own_credentials)), options{folder / "fleet.db", domain.number(), {}} {
    if (!security.empty())
      options.arguments = {"--security", security.string()};
    server = std::make_unique<test::ServerProcess>(options);
    panda = Digest::from_hex(ask("teach", Digest(), {})).value();
  }

  /// What a process in this role says.
  std::string ask(const std::string& role, const Digest& robot,
                  const std::vector<std::string>& more) const {
    if (!credentials.empty())
      setenv("KINSHIP_SECURITY", credentials.c_str(), 1);
    test::ChildProcess process = bench::start_role(role, domain.number(), robot, more);
    unsetenv("KINSHIP_SECURITY");
    return process.read_line();
  }

  double fetch_us() const { return std::stod(ask("fetches", panda, {})); }
  double reports_per_s() const {
    constexpr double kSeconds = 2;
    return std::stod(ask("reports", panda, {"0", std::to_string(kSeconds)})) / kSeconds;
  }

  const test::ReservedDomain domain;
  const fs::path credentials;
  test::ServerProcess::Options options;
  std::unique_ptr<test::ServerProcess> server;
  Digest panda;
};

/// The median of fetches from memory.
double fetch_often(std::uint32_t domain, const Digest& panda) {
  constexpr int kFetches = 500;
  link::Client client(bench::without_outbox(domain));
  std::vector<double> times_us;
  for (int i = 0; i < kFetches; ++i) {
    const double start_s = bench::wall_s();
    client.fetch(bench::request_for(panda)).value_or_throw();
    times_us.push_back(1e6 * (bench::wall_s() - start_s));
  }
  return bench::median(times_us);
}

void compare(const Side& secured, const Side& open) {
  constexpr int kRounds = 5;
  std::vector<double> secured_us, open_us, secured_rates, open_rates;
  for (int round = 0; round < kRounds; ++round) {
    secured_us.push_back(secured.fetch_us());
    open_us.push_back(open.fetch_us());
    secured_rates.push_back(secured.reports_per_s());
    open_rates.push_back(open.reports_per_s());
  }
  bench::print({.name = "30 KB from memory with security, p50",
                .value = bench::median(secured_us),
                .unit = "us",
                .reference = bench::Reference{"without", bench::median(open_us)}});
  bench::print({.name = "reports of 8 KB over DDS with security, 4 clients",
                .value = bench::median(secured_rates),
                .unit = "reports/s",
                .better = bench::Better::Higher,
                .reference = bench::Reference{"without", bench::median(open_rates)}});
}

void run() {
  const test::TemporaryDirectory directory{test::disk_root()};
  const security::SecurityFolder fleet =
      security::SecurityFolder::init(directory / "security", security::kDefaultDays, now());
  const auto add = [&](const std::string& name, const fs::path& out) {
    fleet.add({.name = name, .role = AccessRole::Admin}, out, now());
    return out;
  };
  for (const char* const name : {"secured", "open"})
    fs::create_directories(directory / name);
  Side secured(directory / "secured", directory / "security", add("bench", directory / "bench"));
  const Side open(directory / "open", {}, {});
  compare(secured, open);
  std::vector<std::string> credentials;
  for (int i = 0; i < kProcesses; ++i) {
    const std::string name = "client_" + std::to_string(i);
    credentials.push_back(add(name, directory / name.c_str()).string());
  }
  bench::measure_restart("100 clients with security", secured.domain.number(), credentials,
                         secured.server, secured.options);
}

std::uint32_t domain_of(const std::vector<std::string>& arguments) {
  return static_cast<std::uint32_t>(std::stoul(arguments[1]));
}

/// All with the same credentials: a process has one name in a domain, and each participant shakes
/// hands for itself.
int run_clients(std::uint32_t domain, const fs::path& credentials) {
  link::ClientOptions options = bench::without_outbox(domain);
  options.security = credentials;
  return bench::run_clients(kClientsOfProcess, options,
                            [](link::Client& client) { client.admin({}).value_or_throw(); });
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 3 && arguments[0] == "clients")
    return run_clients(domain_of(arguments), arguments[2]);
  if (arguments.size() == 3 && arguments[0] == "teach") {
    link::Client client(bench::without_outbox(domain_of(arguments)));
    std::cout << bench::teach(client, kPaths).hex() << std::endl;
  } else if (arguments.size() == 3 && arguments[0] == "fetches") {
    std::cout << fetch_often(domain_of(arguments), Digest::from_hex(arguments[2]).value())
              << std::endl;
  } else if (!bench::run_role(arguments)) {
    run();
  }
  return 0;
}
