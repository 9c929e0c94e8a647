// Pages, jobs, names and placements of robots against an admin replier in this process, over
// loopback.

#include "client/link/admin_rows.hpp"

#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "client/link/reported_placement.hpp"
#include "client/link/robot_names.hpp"
#include "proto/dds/replier.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::link::admin_rows_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Answers admin requests by a function.
class AdminServer {
 public:
  using Answer = std::function<AdminReply(const AdminRequest&)>;

  AdminServer(std::uint32_t domain, Answer answer)
      : participant_({.domain = domain, .role = dds::Role::Server}),
        loop_(participant_),
        admin_(participant_, loop_,
               [answer = std::move(answer)](const AdminRequest& request, const auto& reply) {
                 reply(answer(request));
               }),
        thread_([this] { loop_.run([] { return Clock::time_point::max(); }); }) {}
  ~AdminServer() {
    loop_.stop();
    thread_.join();
  }

 private:
  dds::Participant participant_;
  dds::WaitLoop loop_;
  dds::Replier<codec::AdminConversation> admin_;
  std::thread thread_;
};

Client client(std::uint32_t domain, std::chrono::milliseconds timeout = 30s) {
  return Client({.domain = domain, .outbox = {}, .has_outbox = false, .timeout = timeout});
}

AdminReply page(std::vector<std::string> rows, const std::string& next_cursor,
                bool last_row_continues = false) {
  AdminReply reply;
  reply.status = AdminStatus::Ok;
  reply.rows = std::move(rows);
  reply.next_cursor = next_cursor;
  reply.last_row_continues = last_row_continues;
  return reply;
}

/// Rows a, bcd (in three pieces, one of them a page of its own), e, f.
AdminReply pieces(const AdminRequest& request) {
  if (request.cursor.empty())
    return page({"a", "b"}, "1", true);
  if (request.cursor == "1")
    return page({"c"}, "2", true);
  if (request.cursor == "2")
    return page({"d", "e"}, "3");
  return page({"f"}, "");
}

using Rows = std::vector<std::string>;

TEST(AdminRows, RowsInPiecesComeWhole) {
  const test::ReservedDomain domain;
  const AdminServer server(domain.number(), pieces);
  Client asker = client(domain.number());
  const auto rows = rows_of(asker, {});
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(*rows, (Rows{"a", "bcd", "e", "f"}));
}

TEST(AdminRows, EndsAtTheLimitOrWhenItsUserHasEnough) {
  const test::ReservedDomain domain;
  const AdminServer server(domain.number(), pieces);
  Client asker = client(domain.number());
  Rows rows;
  const auto use = [&](const std::string& row) {
    rows.push_back(row);
    return row != "e";
  };
  EXPECT_FALSE(for_each_row(asker, {}, use, 2));
  EXPECT_EQ(rows, (Rows{"a", "bcd"}));
  rows.clear();
  EXPECT_FALSE(for_each_row(asker, {}, use));
  EXPECT_EQ(rows, (Rows{"a", "bcd", "e"}));
}

TEST(AdminRows, ARefusalIsAnErrorWithTheServersWords) {
  const test::ReservedDomain domain;
  const AdminServer server(domain.number(), [](const AdminRequest&) {
    AdminReply reply;
    reply.status = AdminStatus::NotFound;
    reply.message = "no task 'x'";
    return reply;
  });
  Client asker = client(domain.number());
  const auto rows = rows_of(asker, {});
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().code, ErrorCode::NotFound);
  EXPECT_EQ(rows.error().message, "no task 'x'");
}

TEST(AdminRows, AJobIsWaitedForAndItsProgressTold) {
  const test::ReservedDomain domain;
  int asked = 0;
  const AdminServer server(domain.number(), [&](const AdminRequest& request) {
    EXPECT_EQ(request.verb, AdminVerb::ShowJob);
    EXPECT_EQ(request.argument, "00c0ffee");
    Job job;
    job.id = request.argument;
    job.verb = "backup";
    job.state = ++asked < 3 ? JobState::Running : JobState::Done;
    job.progress = 0.25 * asked;
    return page({json::to_json(job)}, "");
  });
  Client asker = client(domain.number());
  std::vector<double> told;
  const auto job = wait_for_job(asker, "00c0ffee", Clock::now() + 60s,
                                [&](const Job& now) { told.push_back(now.progress); });
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->state, JobState::Done);
  EXPECT_EQ(told, (std::vector<double>{0.25, 0.5, 0.75}));
}

TEST(AdminRows, AJobThatGoesOnIsTheAnswerWhenTheTimeHasCome) {
  const test::ReservedDomain domain;
  const AdminServer server(domain.number(), [](const AdminRequest& request) {
    Job job;
    job.id = request.argument;
    job.state = JobState::Running;
    return page({json::to_json(job)}, "");
  });
  Client asker = client(domain.number());
  const auto job = wait_for_job(asker, "00c0ffee", Clock::now());
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_FALSE(has_ended(*job));
}

/// Knows robots by name, as `robots show` answers.
AdminServer::Answer shown(std::map<std::string, Digest> robots) {
  return [robots = std::move(robots)](const AdminRequest& request) {
    AdminReply reply;
    const auto robot = robots.find(request.argument);
    if (request.verb != AdminVerb::ShowRobot || robot == robots.end()) {
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
  };
}

Digest digest(std::uint8_t first) {
  Digest digest;
  digest.bytes[0] = first;
  return digest;
}

TEST(ResolveRobots, GivesAscendingDistinctDigests) {
  const test::ReservedDomain domain;
  const AdminServer server(
      domain.number(), shown({{"panda", digest(9)}, {"iiwa14", digest(3)}, {"0900", digest(9)}}));
  Client asker = client(domain.number());
  EXPECT_EQ(*resolve_robots(asker, {"panda", "iiwa14", "0900"}),
            (std::vector<Digest>{digest(3), digest(9)}));
  EXPECT_TRUE(resolve_robots(asker, {})->empty());
  EXPECT_EQ(find_robot(asker, "iiwa14")->robot, digest(3));
}

TEST(ResolveRobots, NamesTheRobotThatIsNotThere) {
  const test::ReservedDomain domain;
  const AdminServer server(domain.number(), shown({{"panda", digest(9)}}));
  Client asker = client(domain.number());
  const auto robots = resolve_robots(asker, {"panda", "sawyer"});
  ASSERT_FALSE(robots);
  EXPECT_EQ(robots.error().code, ErrorCode::NotFound);
  EXPECT_EQ(robots.error().message, "no robot 'sawyer'");
}

TEST(ResolveRobots, WithoutAServerIsUnavailable) {
  const test::ReservedDomain domain;
  Client asker = client(domain.number(), 200ms);
  const auto robots = resolve_robots(asker, {"panda"});
  ASSERT_FALSE(robots);
  EXPECT_EQ(robots.error().code, ErrorCode::Unavailable);
}

TEST(ReportedPlacements, ATaskThatTheServerDoesNotKnowIsNotReported) {
  const test::ReservedDomain domain;
  AdminStatus status = AdminStatus::NotFound;
  const AdminServer server(domain.number(), [&](const AdminRequest& request) {
    EXPECT_EQ(request.verb, AdminVerb::FindAttempts);
    AdminReply reply;
    reply.status = status;
    reply.message = "no task 'x'";
    return reply;
  });
  Client asker = client(domain.number());
  const auto unknown = reported_placement(asker, "x", "panda");
  ASSERT_TRUE(unknown) << unknown.error().message;
  EXPECT_FALSE(unknown->is_known);
  EXPECT_FALSE(unknown->T_task_base);
  status = AdminStatus::Refused;
  const auto refused = reported_placement(asker, "x", "panda");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
}

TEST(ReportedPlacements, AnAttemptThatIsDroppedMeanwhileIsAskedForOnceMore) {
  const test::ReservedDomain domain;
  std::map<AdminVerb, int> asked;
  const AdminServer server(domain.number(), [&](const AdminRequest& request) {
    ++asked[request.verb];
    AdminReply reply;
    if (request.verb == AdminVerb::FindAttempts)
      return page({json::to_json(AttemptSummary())}, "");
    reply.status = AdminStatus::NotFound;
    return reply;
  });
  Client asker = client(domain.number());
  const auto placement = reported_placement(asker, "x", "panda");
  ASSERT_TRUE(placement) << placement.error().message;
  EXPECT_FALSE(placement->is_known);
  EXPECT_EQ(asked[AdminVerb::FindAttempts], 2);
  EXPECT_EQ(asked[AdminVerb::ShowPath], 2);
}

}  // namespace
}  // namespace kinship::link::admin_rows_test
