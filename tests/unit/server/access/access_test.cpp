#include "server/access/access.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

#include "proto/types/enum_text.hpp"

namespace kinship::access::access_test {
namespace {

Caller named(const std::string& name, AccessRole role) {
  Caller caller;
  caller.client = name;
  caller.name = name;
  caller.role = role;
  caller.is_local = false;
  return caller;
}

Caller without_security(bool is_local) {
  Caller caller;
  caller.client = "0110f31a";
  caller.role = AccessRole::Admin;
  caller.is_local = is_local;
  return caller;
}

std::string words(const std::optional<Error>& refusal) { return refusal ? refusal->message : ""; }

std::set<std::string> allowed(const Caller& caller) {
  std::set<std::string> names;
  for (const VerbRule& rule : kVerbRules)
    if (!refusal_of(caller, rule.verb))
      names.emplace(rule.name);
  return names;
}

TEST(VerbRules, EachVerbHasOneUnderANameOfItsOwn) {
  std::set<std::string_view> names, acts;
  for (std::uint32_t verb = 0; verb <= static_cast<std::uint32_t>(kLastVerb); ++verb) {
    const VerbRule& rule = rule_of(static_cast<AdminVerb>(verb));
    EXPECT_EQ(static_cast<std::uint32_t>(rule.verb), verb);
    EXPECT_TRUE(names.insert(rule.name).second) << rule.name;
    EXPECT_TRUE(acts.insert(rule.act).second) << rule.act;
  }
  EXPECT_EQ(names.size(), kVerbRules.size());
}

TEST(VerbRules, ARoleMayWhatItIsForAndWhatTheOneBeforeItMay) {
  const std::set<std::string> robot = allowed(named("r", AccessRole::Robot));
  EXPECT_EQ(robot, std::set<std::string>{"status"});
  const std::set<std::string> reader = {"status",
                                        "list_robots",
                                        "show_robot",
                                        "list_tasks",
                                        "show_task",
                                        "list_paths",
                                        "show_path",
                                        "list_distributions",
                                        "show_distribution",
                                        "explain_distribution",
                                        "export_configurations",
                                        "export_paths",
                                        "show_job",
                                        "cancel_job",
                                        "job_rows",
                                        "list_attempts",
                                        "find_attempts",
                                        "list_meshes"};
  EXPECT_EQ(allowed(named("r", AccessRole::Reader)), reader);
  std::set<std::string> more = reader;
  for (const char* const name :
       {"evict_distribution", "retire_path", "reset_task", "backup", "list_backups", "hash_backup",
        "read_backup", "list_jobs", "list_clients", "list_audit", "restore_path"})
    more.insert(name);
  EXPECT_EQ(allowed(named("o", AccessRole::Operator)), more);
  more.insert({"rename_robot", "remove_robot", "rename_task", "remove_task"});
  EXPECT_EQ(allowed(named("a", AccessRole::Admin)), more);
  EXPECT_EQ(more.size(), kVerbRules.size());
}

TEST(Access, ARefusalSaysWhoWhatAndWhatItWouldTake) {
  EXPECT_EQ(words(refusal_of(named("robot_7", AccessRole::Robot), AdminVerb::ResetTask)),
            "robot_7 (role robot) may not reset tasks: needs role operator");
  EXPECT_EQ(words(refusal_of(named("anna", AccessRole::Operator), AdminVerb::RemoveRobot)),
            "anna (role operator) may not remove robots: needs role admin");
  EXPECT_EQ(words(refusal_of_report(named("anna", AccessRole::Reader), "bin", "panda")),
            "anna (role reader) may not report: needs role robot or admin");
  EXPECT_EQ(words(refusal_of_registration(named("anna", AccessRole::Operator), "panda")),
            "anna (role operator) may not register robots: needs role robot or admin");
}

TEST(Access, WhereATokenIsNeededOnlyTheTokenCounts) {
  for (const bool is_local : {false, true}) {
    Caller caller = without_security(is_local);
    caller.token = TokenProof::Missing;
    const std::string missing = words(refusal_of(caller, AdminVerb::ResetTask));
    EXPECT_NE(missing.find("where that needs its token: kinship --token FILE"), std::string::npos)
        << missing;
    EXPECT_TRUE(refusal_of_job(caller, AdminVerb::CancelJob, "3f9a0c11"));
    EXPECT_FALSE(refusal_of(caller, AdminVerb::ListPaths));
    caller.token = TokenProof::Wrong;
    const std::string wrong = words(refusal_of(caller, AdminVerb::Backup));
    EXPECT_NE(wrong.find("the proof of the token is wrong"), std::string::npos) << wrong;
    caller.token = TokenProof::Shown;
    EXPECT_FALSE(refusal_of(caller, AdminVerb::ResetTask));
    EXPECT_FALSE(refusal_of_job(caller, AdminVerb::CancelJob, "3f9a0c11"));
  }
}

TEST(Access, WithoutSecurityAnotherHostMayReadAndReportButChangeNothing) {
  const Caller here = without_security(true), elsewhere = without_security(false);
  for (const VerbRule& rule : kVerbRules) {
    EXPECT_EQ(words(refusal_of(here, rule.verb)), "") << rule.name;
    EXPECT_EQ(refusal_of(elsewhere, rule.verb).has_value(),
              rule.is(VerbRule::Changes) && rule.verb != AdminVerb::CancelJob)
        << rule.name;
  }
  EXPECT_EQ(words(refusal_of(elsewhere, AdminVerb::ResetTask)),
            "a client on another host may not reset tasks: this server runs without security, "
            "where that is for its own machine alone; kinshipd --security has certificates tell "
            "who may do it");
  EXPECT_FALSE(refusal_of_report(elsewhere, "bin", "panda"));
  EXPECT_FALSE(refusal_of_registration(elsewhere, "panda"));
  EXPECT_FALSE(refusal_of_fetch(elsewhere, "bin", "panda"));
  EXPECT_TRUE(refusal_of_job(elsewhere, AdminVerb::CancelJob, "3f9a0c11"));
  EXPECT_FALSE(refusal_of_job(elsewhere, AdminVerb::ShowJob, "3f9a0c11"));
  EXPECT_FALSE(refusal_of_job(here, AdminVerb::CancelJob, "3f9a0c11"));
}

TEST(Access, WithACertificateItDoesNotMatterWhereItAsksFrom) {
  Caller caller = named("anna", AccessRole::Operator);
  for (const bool is_local : {false, true}) {
    caller.is_local = is_local;
    EXPECT_FALSE(refusal_of(caller, AdminVerb::ResetTask));
    EXPECT_TRUE(refusal_of(caller, AdminVerb::RenameRobot));
  }
}

TEST(Access, AJobOfAnotherNeedsAnOperator) {
  EXPECT_EQ(words(refusal_of_job(named("r", AccessRole::Reader), AdminVerb::CancelJob, "3f9a")),
            "r (role reader) may not cancel job '3f9a': it is not its own, which needs role "
            "operator");
  EXPECT_TRUE(refusal_of_job(named("r", AccessRole::Reader), AdminVerb::JobRows, "3f9a"));
  EXPECT_FALSE(refusal_of_job(named("o", AccessRole::Operator), AdminVerb::CancelJob, "3f9a"));
}

TEST(Access, NarrowedItIsForTheseTasksAndRobotsOnly) {
  Caller robot = named("robot_7", AccessRole::Robot);
  EXPECT_FALSE(refusal_of_registration(robot, "any")) << "not narrowed: for any robot";
  robot.tasks = {"bin_*", "shelf"};
  robot.robots = {"panda"};
  EXPECT_FALSE(refusal_of_report(robot, "bin_3", "panda"));
  EXPECT_FALSE(refusal_of_fetch(robot, "shelf", "panda"));
  EXPECT_EQ(words(refusal_of_report(robot, "drawer", "panda")),
            "robot_7 (role robot) may not report for task 'drawer': its certificate is for tasks "
            "bin_*, shelf, robots panda");
  EXPECT_EQ(words(refusal_of_fetch(robot, "shelf", "ur5e")),
            "robot_7 (role robot) may not fetch for robot 'ur5e': its certificate is for tasks "
            "bin_*, shelf, robots panda");
  EXPECT_EQ(words(refusal_of_registration(robot, "ur5e")),
            "robot_7 (role robot) may not register robot 'ur5e': its certificate is for tasks "
            "bin_*, shelf, robots panda");
  EXPECT_TRUE(refusal_of_task(robot, "drawer"));
  EXPECT_TRUE(refusal_of_robot(robot, "pandas"));
  EXPECT_TRUE(may_see(robot, "", "panda"));
  EXPECT_TRUE(may_see(robot, "shelf", ""));
  EXPECT_FALSE(may_see(robot, "shelf", "ur5e"));
  EXPECT_FALSE(may_see(robot, "shelves", "panda"));
}

TEST(Access, AnAdministratorMayBeNarrowedToo) {
  Caller admin = named("root", AccessRole::Admin);
  EXPECT_FALSE(is_narrowed(admin));
  admin.tasks = {"bin"};
  EXPECT_TRUE(is_narrowed(admin));
  EXPECT_TRUE(refusal_of_report(admin, "shelf", "panda"));
}

TEST(Access, NarrowedItDoesNothingThatReachesBeyondWhatItIsFor) {
  Caller admin = named("root", AccessRole::Admin);
  admin.tasks = {"bin"};
  EXPECT_EQ(words(refusal_of(admin, AdminVerb::ListAudit)),
            "root (role admin) may not read the audit log: that is about all tasks and robots, its "
            "certificate is for tasks bin");
  for (const AdminVerb verb :
       {AdminVerb::Backup, AdminVerb::ListJobs, AdminVerb::RemoveRobot, AdminVerb::RenameRobot})
    EXPECT_TRUE(refusal_of(admin, verb)) << rule_of(verb).name;
  constexpr std::array kOfATask = {AdminVerb::ResetTask, AdminVerb::RenameTask,
                                   AdminVerb::RemoveTask};
  for (const AdminVerb verb : kOfATask)
    EXPECT_FALSE(refusal_of(admin, verb)) << rule_of(verb).name;
  admin.tasks.clear();
  admin.robots = {"panda"};
  for (const AdminVerb verb : kOfATask)
    EXPECT_NE(words(refusal_of(admin, verb)).find("that reaches beyond what it is for"),
              std::string::npos)
        << rule_of(verb).name;
  for (const AdminVerb verb : {AdminVerb::RemoveRobot, AdminVerb::RenameRobot})
    EXPECT_FALSE(refusal_of(admin, verb)) << rule_of(verb).name;
  EXPECT_FALSE(refusal_of(admin, AdminVerb::RestorePath)) << "with the robot that it names";
}

TEST(Access, NarrowedItHearsOfWhatNamesATaskAndARobotOfItsOwn) {
  const Event shelf{EventKind::Report, 1, "shelf", "panda", "..."};
  const Event words{EventKind::Refusal, 1, "", "", "1 of 1 attempts refused, first: ... 'bin'"};
  Caller caller = named("anna", AccessRole::Reader);
  EXPECT_TRUE(may_hear(caller, shelf) && may_hear(caller, words));
  EXPECT_FALSE(may_hear(named("r", AccessRole::Robot), shelf));
  EXPECT_TRUE(may_hear(without_security(false), words));
  caller.tasks = {"shelf"};
  EXPECT_TRUE(may_hear(caller, shelf));
  EXPECT_FALSE(may_hear(caller, words));
  caller.robots = {"ur5e"};
  EXPECT_FALSE(may_hear(caller, shelf));
  caller.tasks.clear();
  EXPECT_FALSE(may_hear(caller, {EventKind::Fetch, 1, "shelf", "", "for no robot"}));
}

TEST(Access, PatternsHaveStarsAndQuestionMarks) {
  for (const auto& [pattern, text] :
       {std::pair("", ""), std::pair("*", ""), std::pair("*", "abc"), std::pair("a*c", "abbbc"),
        std::pair("a*c", "ac"), std::pair("a?c", "abc"), std::pair("**b*", "aab"),
        std::pair("*ab", "aab"), std::pair("a*b*c", "a-b-b-c"), std::pair("a.c", "a.c")})
    EXPECT_TRUE(matches(pattern, text)) << pattern << " " << text;
  for (const auto& [pattern, text] :
       {std::pair("", "a"), std::pair("?", ""), std::pair("a*c", "abcd"), std::pair("a?c", "ac"),
        std::pair("abc", "ab"), std::pair("ab", "abc"), std::pair("a.c", "abc"),
        std::pair("A*", "abc"), std::pair("*ab", "aba")})
    EXPECT_FALSE(matches(pattern, text)) << pattern << " " << text;
  const std::string many_stars(60, '*');
  EXPECT_FALSE(matches(many_stars + "b" + many_stars + "c", std::string(100, 'b')));
}

}  // namespace
}  // namespace kinship::access::access_test
