// A fetch that kinshipd answers from memory, through Client, against a bare request/reply over
// Cyclone DDS with the same messages and QoS: processes on loopback, blocks of both taking turns.
// What the whole of Kinship adds.
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
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using std::chrono::seconds;

constexpr int kRoundTrips = 10'000;
constexpr int kBlock = 100;
constexpr std::uint64_t kPaths = 100;

FetchRequest request_for(const Digest& robot) {
  FetchRequest request;
  request.task = "sweep";
  request.robot = robot;
  request.deadline = seconds(60);
  return request;
}

/// Fetches once from kinshipd and then serves that reply, bare.
int run_bare(std::uint32_t domain, std::uint32_t bare_domain, const Digest& robot) {
  link::Client client({.domain = domain, .outbox = {}, .has_outbox = false});
  const FetchReply reply = client.fetch(request_for(robot)).value_or_throw();
  const dds::Participant participant({.domain = bare_domain, .role = dds::Role::Server});
  bench::Bare bare(participant, true);
  std::cout << "ready" << std::endl;
  bare.serve(reply);
}

void measure(int times, const std::function<void()>& call, std::vector<double>& times_us) {
  for (int i = 0; i < times; ++i) {
    const double start_s = bench::wall_s();
    call();
    times_us.push_back(1e6 * (bench::wall_s() - start_s));
  }
}

void print(const std::string& name, double share, const std::vector<double>& ours,
           const std::vector<double>& bares, std::optional<double> ratio_budget) {
  bench::print({.name = name,
                .value = bench::percentile(ours, share),
                .unit = "us",
                .reference = bench::Reference{"bare Cyclone DDS", bench::percentile(bares, share)},
                .ratio_budget = ratio_budget});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::string(argv[1]) == "bare")
    return run_bare(static_cast<std::uint32_t>(std::stoul(argv[2])),
                    static_cast<std::uint32_t>(std::stoul(argv[3])),
                    Digest::from_hex(argv[4]).value());
  const test::ReservedDomain domain, bare_domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  const test::ServerProcess server(
      {.store = directory / "fleet.db", .domain = domain.number(), .arguments = {}});
  link::Client client({.domain = domain.number(), .outbox = directory / "outbox"});
  const Digest panda =
      client.register_robot(test::model_description("panda")).value_or_throw().robot;
  for (std::uint64_t i = 0; i < kPaths; ++i)
    client.report(test::panda_attempt(panda, "sweep", i));
  client.flush(seconds(60));
  const FetchRequest request = request_for(panda);
  client.fetch(request).value_or_throw();
  test::ChildProcess bare_server({"/proc/self/exe", "bare", std::to_string(domain.number()),
                                  std::to_string(bare_domain.number()), panda.hex()});
  bare_server.read_line();
  const dds::Participant participant({.domain = bare_domain.number()});
  bench::Bare bare(participant, false);
  bare.call(request);  // connected after it
  std::vector<double> ours, bares;
  for (int done = 0; done < kRoundTrips; done += kBlock) {
    measure(
        kBlock, [&] { client.fetch(request).value_or_throw(); }, ours);
    measure(
        kBlock, [&] { bare.call(request); }, bares);
  }
  print("30 KB from memory, p50", 0.5, ours, bares, 1.5);
  print("30 KB from memory, p99", 0.99, ours, bares, {});
  return 0;
}
