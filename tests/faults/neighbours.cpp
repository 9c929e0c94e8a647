#include "tests/faults/neighbours.hpp"

#include <dds/dds.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <thread>

#include "client/link/client.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/wire.hpp"
#include "proto/types/limits.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/raw_conversation.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {
namespace {

using std::chrono::seconds;

/// A line to a server of whose replies nothing is ever taken.
template <typename Conversation>
class DeafLine {
 public:
  explicit DeafLine(const dds::Participant& participant)
      : line_(participant), waitset_(dds_create_waitset(participant.get()), "waitset") {
    const dds_entity_t writer = line_.writer().get();
    dds::require(dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS), "status");
    dds::require(dds_waitset_attach(waitset_.get(), writer, 0), "waitset");
    dds::require(dds_waitset_wait(waitset_.get(), nullptr, 0, DDS_SECS(20)), "a server");
  }

  void send(const typename Conversation::Request& request) {
    const auto message = codec::encode(line_.next_head(), request).value_or_throw();
    // Waits for 100 ms at most; what was lost is lost.
    dds_write(line_.writer().get(), &message.wire);
  }

 private:
  RawLine<Conversation> line_;
  dds::Entity waitset_;
};

/// \param make  the request of a number.
template <typename Conversation>
[[noreturn]] void flood(std::uint32_t domain,
                        const std::function<typename Conversation::Request(std::uint64_t)>& make) {
  constexpr std::uint64_t kBegun = 20;
  const dds::Participant participant({.domain = domain});
  DeafLine<Conversation> line(participant);
  for (std::uint64_t i = 0;; ++i) {
    line.send(make(i));
    if (i == kBegun)
      std::cout << "ready" << std::endl;
  }
}

ReportRequest reports(const Digest& panda, std::uint64_t number) {
  constexpr std::uint64_t kAttempts = 16, kOthers = 1'000'000'000;
  ReportRequest request;
  for (std::uint64_t i = 0; i < kAttempts; ++i)
    request.attempts.push_back(panda_attempt(panda, "flood", kOthers + number * kAttempts + i));
  return request;
}

/// Each at another place, so that each would be a fit.
FetchRequest cold_fetch(const Digest& panda, std::uint64_t number) {
  FetchRequest request;
  request.task = "sweep";
  request.robot = panda;
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.T_task_base->translation().x() = 0.001 * static_cast<double>(number % 100'000);
  request.deadline = seconds(60);
  return request;
}

AdminRequest long_answer(std::uint64_t number) {
  AdminRequest request;
  request.verb = number % 2 == 0 ? AdminVerb::ListPaths : AdminVerb::ExportPaths;
  request.limit = kMaxPageRows;
  return request;
}

/// Known ones, and some that cannot be read.
RobotDescription registration(const RobotDescription& panda, std::uint64_t number) {
  RobotDescription description = panda;
  if (number % 4 == 0)
    description.urdf.resize(description.urdf.size() / 2);
  return description;
}

int stopped(std::uint32_t domain, const Digest& panda) {
  link::Client client({.domain = domain, .outbox = {}, .has_outbox = false});
  const auto watcher = client.watch({.on_event = [](const Event&) {}});
  FetchRequest request = cold_fetch(panda, 0);
  const auto follower = client.follow(request);
  follower->wait_for_newer(nullptr, std::chrono::steady_clock::now() + seconds(60));
  request.minimum_generation = 1'000'000;  // never
  std::thread asker([&] { static_cast<void>(client.fetch(request)); });
  std::cout << "ready" << std::endl;
  asker.join();
  return 0;
}

/// Hands over and says how many were stored.
int deliver_all(std::uint32_t domain, std::uint64_t count,
                const std::function<Attempt(std::uint64_t)>& make) {
  constexpr std::uint64_t kTogether = 64;
  link::Client client(
      {.domain = domain, .outbox = {}, .has_outbox = false, .timeout = seconds(60)});
  std::size_t stored = 0;
  for (std::uint64_t i = 0; i < count;) {
    std::vector<Attempt> attempts;
    for (; attempts.size() < kTogether && i < count; ++i)
      attempts.push_back(make(i));
    if (i == attempts.size())
      std::cout << "ready" << std::endl;
    for (const Receipt& receipt : client.deliver(std::move(attempts)).value_or_throw())
      if (receipt.status == ReceiptStatus::Stored)
        ++stored;
  }
  std::cout << "done " << stored << std::endl;
  return 0;
}

/// Three joints in a plane: a path of the most waypoints fits into a batch.
RobotDescription small_arm() {
  RobotDescription description;
  description.label = "small_arm";
  std::string urdf = "<robot name='small_arm'><link name='link_0'/>";
  for (int joint = 1; joint <= 3; ++joint) {
    const std::string number = std::to_string(joint);
    urdf += "<link name='link_" + number + "'/><joint name='joint_" + number +
            "' type='revolute'><origin xyz='0.5 0 0'/><parent link='link_" +
            std::to_string(joint - 1) + "'/><child link='link_" + number +
            "'/><axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>";
  }
  description.urdf = urdf + "</robot>";
  description.base_link = "link_0";
  description.tip_link = "link_3";
  return description;
}

Attempt longest_path(const Digest& robot, std::uint64_t number) {
  Attempt attempt = panda_attempt(robot, "long", number);
  const double phase = 0.01 * static_cast<double>(number);
  attempt.path = Path(Eigen::MatrixXd::NullaryExpr(
      3, kMaxWaypoints, [&](Eigen::Index joint, Eigen::Index waypoint) {
        return 2 *
               std::sin(1e-3 * static_cast<double>(waypoint) + phase + static_cast<double>(joint));
      }));
  return attempt;
}

int long_paths(std::uint32_t domain) {
  constexpr std::uint64_t kPaths = 1'000'000 / kMaxWaypoints + 1;
  Digest robot;
  {
    link::Client client(
        {.domain = domain, .outbox = {}, .has_outbox = false, .timeout = seconds(20)});
    robot = client.register_robot(small_arm()).value_or_throw().robot;
  }
  return deliver_all(domain, kPaths, [&](std::uint64_t i) { return longest_path(robot, i); });
}

int long_leases(std::uint32_t domain, const Digest& panda) {
  constexpr std::size_t kLeases = 4096;
  link::Client client(
      {.domain = domain, .outbox = {}, .has_outbox = false, .timeout = seconds(20)});
  FetchRequest request;
  request.robot = panda;
  request.follow = seconds(kMaxFollow_s);
  std::size_t answered = 0;
  for (std::size_t i = 0; i < kLeases; ++i) {
    request.task = "leased_" + std::to_string(i);
    const Result<FetchReply> reply = client.fetch(request);
    answered += reply ? 1U : 0U;
    if (i == 0)
      std::cout << "ready" << std::endl;
  }
  std::cout << "done " << answered << std::endl;
  pause();
  return 0;
}

}  // namespace

int run_neighbour(const std::vector<std::string>& arguments) {
  const std::string& kind = arguments.at(0);
  const auto domain = static_cast<std::uint32_t>(std::stoul(arguments.at(1)));
  const Digest panda = model_chain("panda").digest();
  const RobotDescription description = model_description("panda");
  if (kind == "report")
    flood<codec::ReportConversation>(domain, [&](std::uint64_t i) { return reports(panda, i); });
  if (kind == "fetch")
    flood<codec::FetchConversation>(domain, [&](std::uint64_t i) { return cold_fetch(panda, i); });
  if (kind == "admin")
    flood<codec::AdminConversation>(domain, long_answer);
  if (kind == "register")
    flood<codec::RegisterConversation>(
        domain, [&](std::uint64_t i) { return registration(description, i); });
  if (kind == "stopped")
    return stopped(domain, panda);
  if (kind == "long-paths")
    return long_paths(domain);
  if (kind == "many-tasks")
    return deliver_all(domain, 10'000, [&](std::uint64_t i) {
      return panda_attempt(panda, "task_" + std::to_string(i), i);
    });
  if (kind == "long-leases")
    return long_leases(domain, panda);
  std::cerr << "neighbour: no kind '" << kind << "'\n";
  return 2;
}

}  // namespace kinship::test
