// What somebody does not achieve at a real kinshipd who has a certificate of its fleet, but an
// expired one or of another role, and a Cyclone DDS that he changed
// (tests/unit/proto/dds/intruder.cpp). Each test first sees him achieve it without security.

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/secured_site.hpp"

namespace kinship::intruder_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using test::ChildProcess;
using test::Site;

class KinshipdIntruder : public test::SecuredSite {
 protected:
  /// What he asks for.
  struct Act {
    std::string verb;
    std::string text;
    std::string way = "honest";
  };
  /// Returns once he has joined; asks again and again until his end.
  /// \param name  common name of the certificate; empty: without security.
  static std::unique_ptr<ChildProcess> intrude(const Site& site, const std::string& name,
                                               const fs::path& credentials, const Act& act) {
    auto process = std::make_unique<ChildProcess>(std::vector<std::string>{
        KINSHIP_INTRUDER, act.verb, std::to_string(site.domain()),
        name.empty() ? "-" : credentials.string(), name.empty() ? "-" : "client_" + name, act.way,
        act.text, site.panda().hex()});
    EXPECT_EQ(process->read_line(), "joined");
    return process;
  }
};

/// The credentials are made with dates of their own; the name is renewed, so that nothing but those
/// dates says no. Without security nothing expires: the counterpart is that they are served before.
TEST_F(KinshipdIntruder, WithAnExpiredCertificateIsNoLongerHeard) {
  constexpr auto kServed = 12s;
  const auto end = test::now_s() + kServed;
  const fs::path old = folder_ / "old", renewed = folder_ / "renewed";
  fleet_.add({.name = "arm", .role = AccessRole::Admin, .days = std::chrono::days(1)}, old,
             end - std::chrono::days(1));
  fleet_.renew("arm", security::kDefaultDays, renewed, test::now_s());
  const Site site = secured_site();
  const auto in_time = intrude(site, "arm", old, {"reset", "in_time"});
  ASSERT_TRUE(site.comes(AdminVerb::ListAudit, "in_time"));
  ASSERT_LT(test::now_s(), end) << "this machine was too slow to serve it before";
  std::this_thread::sleep_until(end + 1s);
  const std::string acts = site.rows(AdminVerb::ListAudit);
  const test::Answer told = site.kinship(old, "status");
  EXPECT_NE(told.code, 0);
  for (const char* const part : {"certificate.pem: expired at ", "kinshipd secure renew arm"})
    EXPECT_TRUE(told.says(part)) << told.err;
  // By his own clock it is not over.
  const auto report = intrude(site, "arm", old, {"report", "too_late", "earlier"});
  const auto other = intrude(site, "arm", old, {"register", "too_late", "earlier"});
  const auto control = intrude(site, "arm.2", renewed, {"report", "renewed"});
  EXPECT_TRUE(site.comes(AdminVerb::ListTasks, "renewed"));
  EXPECT_FALSE(site.has(AdminVerb::ListTasks, "too_late"));
  EXPECT_FALSE(site.has(AdminVerb::ListRobots, "too_late"));
  EXPECT_EQ(site.rows(AdminVerb::ListAudit), acts) << "he who was connected is heard no more, too";
}

TEST_F(KinshipdIntruder, AReaderNeitherReportsNorRegisters) {
  {
    const Site site = open_site();
    const auto report = intrude(site, "", {}, {"report", "forged"});
    const auto registration = intrude(site, "", {}, {"register", "forged_arm"});
    EXPECT_TRUE(site.comes(AdminVerb::ListTasks, "forged"));
    EXPECT_TRUE(site.comes(AdminVerb::ListRobots, "forged_arm"));
  }
  const Site site = secured_site();
  const fs::path reader = add({.name = "rita", .role = AccessRole::Reader});
  std::vector<std::unique_ptr<ChildProcess>> intruders;
  for (const char* const way : {"changed", "hidden"})
    for (const char* const verb : {"report", "register"})
      intruders.push_back(intrude(site, "rita", reader, {verb, "forged", way}));
  // The same program with a robot's certificate is heard, and began last.
  const fs::path robot = add({.name = "arm"});
  intruders.push_back(intrude(site, "arm", robot, {"report", "control", "changed"}));
  intruders.push_back(intrude(site, "arm", robot, {"register", "control", "changed"}));
  EXPECT_TRUE(site.comes(AdminVerb::ListTasks, "control"));
  EXPECT_TRUE(site.comes(AdminVerb::ListRobots, "control"));
  EXPECT_FALSE(site.has(AdminVerb::ListTasks, "forged"));
  EXPECT_FALSE(site.has(AdminVerb::ListRobots, "forged"));
  EXPECT_TRUE(site.has(AdminVerb::ListClients, "\"arm\""));
  EXPECT_FALSE(site.has(AdminVerb::ListClients, "rita")) << "was refused before it was read";
}

TEST_F(KinshipdIntruder, ARobotAdministersNothing) {
  {
    const Site site = open_site();
    site.report("shelf");
    const auto reset = intrude(site, "", {}, {"reset", "shelf"});
    EXPECT_TRUE(site.comes(AdminVerb::ListAudit, "shelf"));
    EXPECT_TRUE(site.loses_path("shelf"));
  }
  const Site site = secured_site();
  site.report("shelf");
  site.report("control");
  const fs::path robot = add({.name = "arm"});
  const fs::path op = add({.name = "olga", .role = AccessRole::Operator});
  const auto changed = intrude(site, "arm", robot, {"reset", "shelf", "changed"});
  const auto hidden = intrude(site, "arm", robot, {"reset", "shelf", "hidden"});
  const auto control = intrude(site, "olga", op, {"reset", "control", "changed"});
  EXPECT_TRUE(site.loses_path("control"));
  EXPECT_FALSE(site.has(AdminVerb::ListAudit, "shelf")) << "was refused before it was read";
  EXPECT_TRUE(site.keeps_path("shelf"));
}

TEST_F(KinshipdIntruder, ARobotReportsForItsTasksOnly) {
  {
    const Site site = open_site();
    const auto report = intrude(site, "", {}, {"report", "shelf"});
    EXPECT_TRUE(site.comes(AdminVerb::ListTasks, "shelf"));
  }
  const Site site = secured_site();
  const fs::path robot = add({.name = "arm", .tasks = {"bin_*"}});
  const auto other = intrude(site, "arm", robot, {"report", "shelf"});
  const auto own = intrude(site, "arm", robot, {"report", "bin_1"});
  EXPECT_TRUE(site.comes(AdminVerb::ListTasks, "bin_1"));
  EXPECT_FALSE(site.has(AdminVerb::ListTasks, "shelf"));
}

}  // namespace
}  // namespace kinship::intruder_test
