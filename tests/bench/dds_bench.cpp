// Round trips of a fetch through Requester and Replier against a bare request/reply over Cyclone
// DDS with messages of the same type, size and QoS, between two processes over loopback, blocks of
// both taking turns. What Kinship adds: checking, encoding, decoding, matching replies to calls.
//
//   dds_bench [ROUND_TRIPS]      prints p50 and p99 in microseconds and the ratio of the p50

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <thread>
#include <vector>

#include "proto/dds/replier.hpp"
#include "proto/dds/requester.hpp"
#include "tests/bench/bare_conversation.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/reserved_domain.hpp"

namespace {

using namespace kinship;
using bench::Bare;
using bench::measure;
using bench::percentile;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kSeed = 41;
constexpr int kBlock = 100;
constexpr std::size_t kComponents = 104;  // x 7 joints: 30 KB

/// The reply to a fetch whose minimum_generation says how large: 0 about 100 bytes, 1 about 30 KB.
FetchReply reply_of_size(std::uint64_t size) {
  FetchReply reply;
  reply.status = FetchStatus::NoExperience;
  reply.message = std::string(60, 'm');
  if (size == 0)
    return reply;
  test::RandomValues values(kSeed);
  const auto d = Eigen::Index{7};
  const auto k = static_cast<Eigen::Index>(kComponents);
  reply.status = FetchStatus::Ready;
  reply.distribution = values.distribution();
  reply.distribution->state = DistributionState::Ready;
  reply.distribution->limits = Eigen::Matrix2Xd::Zero(2, d);
  reply.distribution->mixture =
      Mixture(Eigen::VectorXd::Constant(k, 1.0 / static_cast<double>(k)), values.matrix(d, k),
              std::vector<Eigen::MatrixXd>(kComponents, Eigen::MatrixXd::Identity(d, d)));
  return reply;
}

FetchRequest request_of_size(std::uint64_t size) {
  FetchRequest request;
  request.task = "bench";
  request.minimum_generation = size;
  return request;
}

int run_server(std::uint32_t domain) {
  const dds::Participant participant({.domain = domain, .role = dds::Role::Server});
  Bare bare(participant, true);
  std::thread bare_thread([&] { bare.serve({reply_of_size(0), reply_of_size(1)}); });
  dds::WaitLoop loop(participant);
  const FetchReply small = reply_of_size(0);
  const FetchReply large = reply_of_size(1);
  const dds::Replier<codec::FetchConversation> replier(
      participant, loop, [&](const FetchRequest& request, const auto& answer) {
        answer(request.minimum_generation == 0 ? small : large);
      });
  std::cout << "ready" << std::endl;
  loop.run([] { return Clock::time_point::max(); });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "server")
    return run_server(static_cast<std::uint32_t>(std::atoi(argv[2])));
  const int round_trips = argc > 1 ? std::atoi(argv[1]) : 10'000;
  const test::ReservedDomain domain;
  test::ChildProcess server({argv[0], "server", std::to_string(domain.number())});
  server.read_line();
  const dds::Participant participant({.domain = domain.number()});
  dds::Requester<codec::FetchConversation> requester(participant, Uuid::random());
  const auto kinship_call = [&](std::uint64_t size) {
    requester.call(request_of_size(size), Clock::now() + std::chrono::seconds(10)).value_or_throw();
  };
  Bare bare(participant, false);
  std::printf("%8s %22s %22s %8s\n", "reply", "kinship p50/p99 us", "bare p50/p99 us", "ratio");
  for (const std::uint64_t size : {0U, 1U}) {
    kinship_call(size);  // both are connected after it: the bare entities were made before
    std::vector<double> ours, bares;
    for (int done = 0; done < round_trips; done += kBlock) {
      measure(
          kBlock, [&] { kinship_call(size); }, ours);
      measure(
          kBlock, [&] { bare.call(request_of_size(size)); }, bares);
    }
    const double our_p50 = percentile(ours, 0.5);
    const double bare_p50 = percentile(bares, 0.5);
    std::printf("%8s %12.1f /%8.1f %12.1f /%8.1f %8.2f\n", size == 0 ? "100 B" : "30 KB", our_p50,
                percentile(ours, 0.99), bare_p50, percentile(bares, 0.99), our_p50 / bare_p50);
  }
  return 0;
}
