// A fetch that kinshipd answers from memory, through Client, against a bare request/reply over
// Cyclone DDS with the same messages and QoS: processes on loopback, blocks of both taking turns.
// What the whole of Kinship adds; alone, beside reports at half the rate that the server can take,
// and beside fits, which both sides feel.
//
//   cached_fetch_bench

#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/bare_conversation.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;

constexpr int kBlock = 100;
constexpr std::uint64_t kPaths = 100;

/// Fetches once from kinshipd and then serves that reply, bare.
[[noreturn]] void run_bare(std::uint32_t domain, std::uint32_t bare_domain, const Digest& robot) {
  link::Client client(bench::without_outbox(domain));
  const FetchReply reply = client.fetch(bench::request_for(robot)).value_or_throw();
  const dds::Participant participant({.domain = bare_domain, .role = dds::Role::Server});
  bench::Bare bare(participant, true);
  std::cout << "ready" << std::endl;
  bare.serve(reply);
}

void measure(const std::function<void()>& call, std::vector<double>& times_us) {
  for (int i = 0; i < kBlock; ++i) {
    const double start_s = bench::wall_s();
    call();
    times_us.push_back(1e6 * (bench::wall_s() - start_s));
  }
}

/// Both sides of the comparison.
class Comparison {
 public:
  Comparison(std::uint32_t domain, std::uint32_t bare_domain, const Digest& robot)
      : client_(bench::without_outbox(domain)),
        request_(bench::request_for(robot)),
        bare_server_({"/proc/self/exe", "bare", std::to_string(domain), std::to_string(bare_domain),
                      robot.hex()}),
        is_ready_(bare_server_.read_line() == "ready"),
        participant_({.domain = bare_domain}),
        bare_(participant_, false) {
    bare_.call(request_);  // connected after it
  }

  /// \param beside  what else goes on, for the figures' names.
  void compare(const std::string& beside, int round_trips, std::optional<double> p99_budget) {
    std::vector<double> ours, bares;
    for (int done = 0; done < round_trips; done += kBlock) {
      measure([this] { client_.fetch(request_).value_or_throw(); }, ours);
      measure([this] { bare_.call(request_); }, bares);
    }
    print("30 KB from memory" + beside + ", p50", 0.5, ours, bares, 1.5);
    print("30 KB from memory" + beside + ", p99", 0.99, ours, bares, p99_budget);
  }

 private:
  static void print(const std::string& name, double share, const std::vector<double>& ours,
                    const std::vector<double>& bares, std::optional<double> ratio_budget) {
    bench::print(
        {.name = name,
         .value = bench::percentile(ours, share),
         .unit = "us",
         .reference = bench::Reference{"bare Cyclone DDS", bench::percentile(bares, share)},
         .ratio_budget = ratio_budget});
  }

  link::Client client_;
  FetchRequest request_;
  test::ChildProcess bare_server_;
  bool is_ready_;
  dds::Participant participant_;
  bench::Bare bare_;
};

/// What the server takes from clients that wait for each receipt.
double max_reports_per_s(std::uint32_t domain, const Digest& robot) {
  constexpr double kSeconds = 2;
  test::ChildProcess reporters =
      bench::start_role("reports", domain, robot, {"0", std::to_string(kSeconds)});
  const double rate = std::stod(reporters.read_line()) / kSeconds;
  bench::print({.name = "reports of 8 KB over DDS, 4 clients",
                .value = rate,
                .unit = "reports/s",
                .better = bench::Better::Higher});
  return rate;
}

void run() {
  const test::ReservedDomain domain, bare_domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  // It measures what a server can, not what one client may.
  const test::ServerProcess server(
      {.store = directory / "fleet.db",
       .domain = domain.number(),
       .arguments = {"--client-mb-per-s", "0", "--client-attempts-per-s", "0"}});
  link::Client client(bench::without_outbox(domain.number()));
  const Digest panda = bench::teach(client, kPaths);
  Comparison comparison(domain.number(), bare_domain.number(), panda);
  comparison.compare("", 10'000, {});
  {
    const double half = max_reports_per_s(domain.number(), panda) / 2;
    const test::ChildProcess reporters =
        bench::start_role("reports", domain.number(), panda, {std::to_string(half), "0"});
    comparison.compare(" beside reports at half their rate", 5'000, 5);
  }
  const test::ChildProcess fits = bench::start_role("fits", domain.number(), panda);
  comparison.compare(" beside fits", 5'000, {});
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 4 && arguments[0] == "bare")
    run_bare(static_cast<std::uint32_t>(std::stoul(arguments[1])),
             static_cast<std::uint32_t>(std::stoul(arguments[2])),
             Digest::from_hex(arguments[3]).value());
  if (!bench::run_role(arguments))
    run();
  return 0;
}
