#include "proto/security/permissions.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "proto/security/governance.hpp"

namespace kinship::security {
namespace {

using std::chrono::sys_days;
using namespace std::chrono_literals;

const Validity kValidity{sys_days(2026y / 11 / 24), sys_days(2027y / 11 / 25)};

/// What stands in each <name> of the text, in order.
std::vector<std::string> elements(const std::string& text, const std::string& name) {
  const std::string open = "<" + name + ">";
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    found.push_back(text.substr(at, text.find("</" + name + ">", at) - at));
  }
  return found;
}

struct Access {
  std::set<std::string> publishes;
  std::set<std::string> subscribes;
  std::set<std::string> partitions;
};

Access access_of(const std::string& permissions) {
  const auto topics = [&](const std::string& verb) {
    std::set<std::string> all;
    for (const std::string& criteria : elements(permissions, verb))
      for (const std::string& topic : elements(criteria, "topic"))
        all.insert(topic);
    return all;
  };
  const auto partitions = elements(permissions, "partition");
  return {topics("publish"), topics("subscribe"), {partitions.begin(), partitions.end()}};
}

Access client(AccessRole role) { return access_of(client_permissions("c-1", role, kValidity)); }

TEST(Permissions, ARobotReportsAndFetchesAndDoesNotAdminister) {
  const Access robot = client(AccessRole::Robot);
  EXPECT_EQ(robot.publishes,
            (std::set<std::string>{"kinship/register/request", "kinship/report/request",
                                   "kinship/fetch/request"}));
  EXPECT_EQ(robot.subscribes,
            (std::set<std::string>{"kinship/register/reply", "kinship/report/reply",
                                   "kinship/fetch/reply", "kinship/announcement"}));
}

TEST(Permissions, ReadersAndOperatorsDoNotReport) {
  for (const AccessRole role : {AccessRole::Reader, AccessRole::Operator}) {
    const Access access = client(role);
    EXPECT_EQ(access.publishes,
              (std::set<std::string>{"kinship/fetch/request", "kinship/admin/request"}));
    EXPECT_EQ(access.subscribes,
              (std::set<std::string>{"kinship/fetch/reply", "kinship/admin/reply",
                                     "kinship/announcement", "kinship/event"}));
  }
}

TEST(Permissions, AnAdminHasEveryTopicOfAClient) {
  const Access admin = client(AccessRole::Admin);
  EXPECT_EQ(admin.publishes.size(), 4U);
  EXPECT_EQ(admin.subscribes.size(), 6U);
}

TEST(Permissions, AClientIsInItsOwnPartitionOnlyAndTheRestIsDenied) {
  for (const AccessRole role :
       {AccessRole::Robot, AccessRole::Reader, AccessRole::Operator, AccessRole::Admin}) {
    const std::string text = client_permissions("c-1", role, kValidity);
    EXPECT_EQ(access_of(text).partitions, std::set<std::string>{"client_c-1"});
    EXPECT_EQ(elements(text, "partition").size(), 2U) << "one for each direction: the default "
                                                         "partition is allowed where none stands";
    EXPECT_EQ(elements(text, "default"), std::vector<std::string>{"DENY"});
    EXPECT_EQ(elements(text, "subject_name"), std::vector<std::string>{"CN=c-1,O=Kinship"});
  }
}

TEST(Permissions, TheServerIsTheOtherSideOfEveryRole) {
  const Access server = access_of(server_permissions("server", kValidity));
  const Access admin = client(AccessRole::Admin);
  EXPECT_EQ(server.publishes, admin.subscribes);
  EXPECT_EQ(server.subscribes, admin.publishes);
  EXPECT_EQ(server.partitions, std::set<std::string>{"client_*"});
}

TEST(Permissions, EndWithTheCertificate) {
  const std::string text = client_permissions("c-1", AccessRole::Robot, kValidity);
  EXPECT_EQ(elements(text, "not_before"), std::vector<std::string>{"2026-11-24T00:00:00Z"});
  EXPECT_EQ(elements(text, "not_after"), std::vector<std::string>{"2027-11-25T00:00:00Z"});
}

TEST(Governance, NobodyIsInWithoutACertificateAndNothingIsInClear) {
  const std::string text = governance_text();
  const auto only = [&](const std::string& name) {
    const auto found = elements(text, name);
    return found.size() == 1 ? found.front() : "not once";
  };
  EXPECT_EQ(only("allow_unauthenticated_participants"), "false");
  EXPECT_EQ(only("enable_join_access_control"), "true");
  EXPECT_EQ(only("enable_read_access_control"), "true");
  EXPECT_EQ(only("enable_write_access_control"), "true");
  EXPECT_EQ(only("enable_discovery_protection"), "true");
  EXPECT_EQ(only("discovery_protection_kind"), "ENCRYPT");
  EXPECT_EQ(only("data_protection_kind"), "ENCRYPT");
  EXPECT_NE(only("metadata_protection_kind"), "NONE");
  EXPECT_EQ(only("topic_expression"), "*");
}

}  // namespace
}  // namespace kinship::security
