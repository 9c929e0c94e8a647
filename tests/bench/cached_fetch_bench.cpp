// A fetch that kinshipd answers from memory, through Client, against a bare request/reply over
// Cyclone DDS with the same messages and QoS: processes on loopback, blocks of both taking turns.
// What the whole of Kinship adds.
//
//   fetch_bench [ROUND_TRIPS]      prints p50 and p99 in microseconds and the ratio of the p50

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "client/link/client.hpp"
#include "tests/bench/bare_conversation.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using std::chrono::seconds;

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
  bare.serve({reply});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::string(argv[1]) == "bare")
    return run_bare(static_cast<std::uint32_t>(std::atoi(argv[2])),
                    static_cast<std::uint32_t>(std::atoi(argv[3])),
                    Digest::from_hex(argv[4]).value());
  const int round_trips = argc > 1 ? std::atoi(argv[1]) : 10'000;
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
  const FetchReply reply = client.fetch(request).value_or_throw();
  test::ChildProcess bare_server({argv[0], "bare", std::to_string(domain.number()),
                                  std::to_string(bare_domain.number()), panda.hex()});
  bare_server.read_line();
  const dds::Participant participant({.domain = bare_domain.number()});
  bench::Bare bare(participant, false);
  bare.call(request);  // connected after it
  std::vector<double> ours, bares;
  for (int done = 0; done < round_trips; done += kBlock) {
    bench::measure(
        kBlock, [&] { client.fetch(request).value_or_throw(); }, ours);
    bench::measure(
        kBlock, [&] { bare.call(request); }, bares);
  }
  const double our_p50 = bench::percentile(ours, 0.5);
  const double bare_p50 = bench::percentile(bares, 0.5);
  const auto& mixture = *reply.distribution->mixture;
  std::printf("%d components: kinshipd p50/p99 %.1f / %.1f us, bare %.1f / %.1f us, ratio %.2f\n",
              static_cast<int>(mixture.weights().size()), our_p50, bench::percentile(ours, 0.99),
              bare_p50, bench::percentile(bares, 0.99), our_p50 / bare_p50);
  return 0;
}
