// Names against an admin replier in this process, over loopback.

#include "client/link/robot_names.hpp"

#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "proto/dds/replier.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::link::robot_names_test {
namespace {

using namespace std::chrono_literals;

/// Knows robots by name, as `robots show` answers.
class RobotsServer {
 public:
  RobotsServer(std::uint32_t domain, std::map<std::string, Digest> robots)
      : robots_(std::move(robots)),
        participant_({.domain = domain, .role = dds::Role::Server}),
        loop_(participant_),
        admin_(participant_, loop_,
               [this](const AdminRequest& request, const auto& answer) { answer(show(request)); }),
        thread_(
            [this] { loop_.run([] { return std::chrono::steady_clock::time_point::max(); }); }) {}
  ~RobotsServer() {
    loop_.stop();
    thread_.join();
  }

 private:
  AdminReply show(const AdminRequest& request) const {
    AdminReply reply;
    const auto robot = robots_.find(request.argument);
    if (request.verb != AdminVerb::ShowRobot || robot == robots_.end()) {
      reply.status = AdminStatus::NotFound;
      reply.message = "no robot '" + request.argument + "'";
      return reply;
    }
    RobotSummary summary;
    summary.robot = robot->second;
    summary.label = request.argument;
    reply.status = AdminStatus::Ok;
    reply.rows = {json::to_json(summary), "{\"label\":\"a description\"}"};
    return reply;
  }

  std::map<std::string, Digest> robots_;
  dds::Participant participant_;
  dds::WaitLoop loop_;
  dds::Replier<codec::AdminConversation> admin_;
  std::thread thread_;
};

Digest digest(std::uint8_t first) {
  Digest digest;
  digest.bytes[0] = first;
  return digest;
}

ClientOptions options(std::uint32_t domain, std::chrono::milliseconds timeout) {
  return {.domain = domain, .outbox = {}, .has_outbox = false, .timeout = timeout};
}

TEST(ResolveRobots, GivesAscendingDistinctDigests) {
  const test::ReservedDomain domain;
  const RobotsServer server(domain.number(),
                            {{"panda", digest(9)}, {"iiwa14", digest(3)}, {"0900", digest(9)}});
  Client client(options(domain.number(), 20s));
  EXPECT_EQ(*resolve_robots(client, {"panda", "iiwa14", "0900"}),
            (std::vector<Digest>{digest(3), digest(9)}));
  EXPECT_TRUE(resolve_robots(client, {})->empty());
  EXPECT_EQ(find_robot(client, "iiwa14")->robot, digest(3));
}

TEST(ResolveRobots, NamesTheRobotThatIsNotThere) {
  const test::ReservedDomain domain;
  const RobotsServer server(domain.number(), {{"panda", digest(9)}});
  Client client(options(domain.number(), 20s));
  const auto robots = resolve_robots(client, {"panda", "sawyer"});
  ASSERT_FALSE(robots);
  EXPECT_EQ(robots.error().code, ErrorCode::NotFound);
  EXPECT_EQ(robots.error().message, "no robot 'sawyer'");
}

TEST(ResolveRobots, WithoutAServerIsUnavailable) {
  const test::ReservedDomain domain;
  Client client(options(domain.number(), 200ms));
  const auto robots = resolve_robots(client, {"panda"});
  ASSERT_FALSE(robots);
  EXPECT_EQ(robots.error().code, ErrorCode::Unavailable);
}

}  // namespace
}  // namespace kinship::link::robot_names_test
