// Round trips of a fetch through Requester and Replier against a bare request/reply over Cyclone
// DDS with messages of the same type, size and QoS, between two processes over loopback, blocks of
// both taking turns. What Kinship adds: checking, encoding, decoding, matching replies to calls.
//
//   dds_bench [ROUND_TRIPS]      prints p50 and p99 in microseconds and the ratio of the p50

#include <dds/dds.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <thread>
#include <vector>

#include "proto/codec/fetch_codec.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/replier.hpp"
#include "proto/dds/requester.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/random_values.hpp"

namespace {

using namespace kinship;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kDomain = 190;
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

/// One side of the bare conversation: a writer, a reader and a waitset.
class Bare {
 public:
  Bare(const dds::Participant& participant, bool is_server)
      : request_(topic(participant, kinship_wire_FetchRequest_desc, "bench/request")),
        reply_(topic(participant, kinship_wire_FetchReply_desc, "bench/reply")),
        reader_(dds_create_reader(participant.get(), is_server ? request_.get() : reply_.get(),
                                  is_server ? dds::request_qos().get() : dds::reply_qos().get(),
                                  nullptr),
                "reader"),
        writer_(dds_create_writer(participant.get(), is_server ? reply_.get() : request_.get(),
                                  is_server ? dds::reply_qos().get() : dds::request_qos().get(),
                                  nullptr),
                "writer"),
        condition_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "read condition"),
        waitset_(dds_create_waitset(participant.get()), "waitset") {
    dds::require(dds_waitset_attach(waitset_.get(), condition_.get(), 0), "waitset");
  }

  [[noreturn]] void serve() {
    auto small = codec::encode({}, reply_of_size(0)).value_or_throw();
    auto large = codec::encode({}, reply_of_size(1)).value_or_throw();
    while (true) {
      wait();
      const dds::Loan requests(reader_, "bench");
      for (std::size_t i = 0; i < requests.size(); ++i) {
        if (!requests[i])
          continue;
        const auto& request = *static_cast<const kinship_wire_FetchRequest*>(requests[i]);
        auto& reply = request.minimum_generation == 0 ? small.wire : large.wire;
        reply.sequence_number = request.sequence_number;
        dds_write(writer_.get(), &reply);
      }
    }
  }

  void call(std::uint64_t size) {
    auto request =
        codec::encode({Uuid{}, ++sequence_number_}, request_of_size(size)).value_or_throw();
    dds_write(writer_.get(), &request.wire);
    while (true) {
      wait();
      const dds::Loan replies(reader_, "bench");
      for (std::size_t i = 0; i < replies.size(); ++i)
        if (replies[i] &&
            static_cast<const kinship_wire_FetchReply*>(replies[i])->sequence_number ==
                sequence_number_)
          return;
    }
  }

 private:
  static dds::Entity topic(const dds::Participant& participant,
                           const dds_topic_descriptor_t& descriptor, const char* name) {
    return {dds_create_topic(participant.get(), &descriptor, name, nullptr, nullptr), name};
  }
  void wait() const {
    dds_attach_t ready = 0;
    dds_waitset_wait(waitset_.get(), &ready, 1, DDS_SECS(1));
  }

  dds::Entity request_, reply_, reader_, writer_, condition_, waitset_;
  std::uint64_t sequence_number_ = 0;
};

int run_server() {
  const dds::Participant participant({.domain = kDomain, .role = dds::Role::Server});
  Bare bare(participant, true);
  std::thread bare_thread([&] { bare.serve(); });
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

double percentile(std::vector<double>& times_us, double share) {
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(times_us.size() - 1));
  std::nth_element(times_us.begin(), times_us.begin() + static_cast<std::ptrdiff_t>(rank),
                   times_us.end());
  return times_us[rank];
}

void measure(const std::function<void()>& call, std::vector<double>& times_us) {
  for (int i = 0; i < kBlock; ++i) {
    const auto start = Clock::now();
    call();
    times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "server")
    return run_server();
  const int round_trips = argc > 1 ? std::atoi(argv[1]) : 10'000;
  test::ChildProcess server({argv[0], "server"});
  server.read_line();
  const dds::Participant participant({.domain = kDomain});
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
      measure([&] { kinship_call(size); }, ours);
      measure([&] { bare.call(size); }, bares);
    }
    const double our_p50 = percentile(ours, 0.5);
    const double bare_p50 = percentile(bares, 0.5);
    std::printf("%8s %12.1f /%8.1f %12.1f /%8.1f %8.2f\n", size == 0 ? "100 B" : "30 KB", our_p50,
                percentile(ours, 0.99), bare_p50, percentile(bares, 0.99), our_p50 / bare_p50);
  }
  return 0;
}
