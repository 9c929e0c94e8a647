// One-shot commands against a local server, process start to process end, in turn with a program
// that asks and is answered once over bare Cyclone DDS.
//
//   command_bench

#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/bare_conversation.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/reference.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using std::chrono::seconds;

constexpr int kTimes = 60;

[[noreturn]] void serve_bare(std::uint32_t domain) {
  const dds::Participant participant({.domain = domain, .role = dds::Role::Server});
  bench::Bare bare(participant, true);
  std::cout << "ready" << std::endl;
  bare.serve({});
}

void ask_bare(std::uint32_t domain) {
  const dds::Participant participant({.domain = domain});
  bench::Bare bare(participant, false);
  bare.connect();
  bare.call(bench::request_for(Digest{}));
}

/// From the start of a program to its end, ms.
double time_ms(const std::vector<std::string>& command) {
  const double start_s = bench::wall_s();
  test::ChildProcess process(command);
  process.read_all();
  if (process.wait() != 0)
    throw std::runtime_error(command.at(0) + ' ' + command.at(1) + " failed");
  return 1e3 * (bench::wall_s() - start_s);
}

void measure(const std::string& name, const std::vector<std::string>& command,
             const std::vector<std::string>& bare) {
  std::vector<double> times_ms, bare_ms;
  for (int i = 0; i < kTimes; ++i) {
    times_ms.push_back(time_ms(command));
    bare_ms.push_back(time_ms(bare));
  }
  for (const auto& [label, share] : {std::pair{"p50", 0.5}, {"p95", 0.95}})
    bench::print({.name = "kinship " + name + ", " + label,
                  .value = bench::percentile(times_ms, share),
                  .unit = "ms",
                  .reference = bench::Reference{"asked once over bare Cyclone DDS",
                                                bench::percentile(bare_ms, share)},
                  .ratio_budget = 1.5});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2) {
    const auto domain = static_cast<std::uint32_t>(std::stoul(argv[2]));
    if (std::string(argv[1]) == "serve-bare")
      serve_bare(domain);
    ask_bare(domain);
    return 0;
  }
  const test::ReservedDomain domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  const test::ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  {
    link::Client client({.domain = domain.number(), .outbox = directory / "outbox"});
    const Digest panda =
        client.register_robot(test::model_description("panda")).value_or_throw().robot;
    for (std::uint64_t i = 0; i < 20; ++i)
      client.report(test::panda_attempt(panda, "sweep", i));
    client.flush(seconds(60));
  }
  const test::ReservedDomain bare_domain;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  const std::string bare_number = std::to_string(bare_domain.number());
  test::ChildProcess bare_server({self, "serve-bare", bare_number});
  bare_server.read_line();
  const std::vector<std::string> bare = {self, "ask-bare", bare_number};
  const auto kinship = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {bench::beside_this_program("kinship"), "--domain",
                                 std::to_string(domain.number())});
    return words;
  };
  measure("status", kinship({"status"}), bare);
  measure(
      "distributions fetch",  // the first has it made, the others find it
      kinship({"distributions", "fetch", "--task", "sweep", "--robot", "panda", "--wait", "60"}),
      bare);
  return 0;
}
