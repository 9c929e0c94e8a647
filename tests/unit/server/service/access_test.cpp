#include "server/access/access.hpp"

#include "server/access/withheld_sources.hpp"
#include "tests/unit/server/service/access_fixture.hpp"

namespace kinship::service::access_test {
namespace {

class Access : public AccessFixture {};

TEST_F(Access, WhatARoleMayNotIsRefusedAndChangesAreInTheAuditLog) {
  report_some();
  const Caller reader = named("anna", AccessRole::Reader);
  const AdminPage reset = ask(reader, AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(reset.status, AdminStatus::Refused);
  EXPECT_EQ(reset.message, "anna (role reader) may not reset tasks: needs role operator");
  EXPECT_EQ(real_store_->find_task("shelf")->paths, 2U);
  EXPECT_EQ(ask(reader, AdminVerb::ListTasks).status, AdminStatus::Ok);
  EXPECT_EQ(ask(named("r", AccessRole::Robot), AdminVerb::ListTasks).status, AdminStatus::Refused);
  EXPECT_EQ(ask(named("otto", AccessRole::Operator), AdminVerb::ResetTask, "shelf").status,
            AdminStatus::Ok);
  EXPECT_EQ(ask(named("otto", AccessRole::Operator), AdminVerb::RemoveRobot, "pupil").status,
            AdminStatus::Refused);
  EXPECT_EQ(log_entries(), (Lines{"anna reset_task shelf refused", "otto reset_task shelf begun",
                                  "otto reset_task shelf done", "otto remove_robot pupil refused"}))
      << "readings are in no log";
  const AdminPage log = ask(named("otto", AccessRole::Operator), AdminVerb::ListAudit, "anna");
  ASSERT_EQ(log.rows.size(), 1U);
  EXPECT_EQ(std::get<AuditEntry>(log.rows[0]).role, "reader");
  EXPECT_EQ(std::get<AuditEntry>(log.rows[0]).message, reset.message);
}

TEST_F(Access, WithoutSecurityAnotherHostChangesNothing) {
  report_some();
  Caller elsewhere;
  elsewhere.client = "0110f31a";
  elsewhere.role = AccessRole::Admin;
  elsewhere.is_local = false;
  elsewhere.address = "10.0.0.7";
  EXPECT_EQ(ask(elsewhere, AdminVerb::ListTasks).status, AdminStatus::Ok);
  const AdminPage reset = ask(elsewhere, AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(reset.status, AdminStatus::Refused);
  EXPECT_NE(reset.message.find("--security"), std::string::npos) << reset.message;
  EXPECT_EQ(real_store_->find_task("shelf")->paths, 2U);
  elsewhere.token = TokenProof::Shown;
  EXPECT_EQ(ask(elsewhere, AdminVerb::ResetTask, "shelf").status, AdminStatus::Ok);
  const std::vector<AuditEntry> log = real_store_->list_audit("", "", 10).rows;
  ASSERT_EQ(log.size(), 3U);
  EXPECT_EQ(log[2].client, "0110f31a, address 10.0.0.7") << "and how it is known";
  EXPECT_FALSE(log[2].is_local);
  EXPECT_EQ(log[0].client, "0110f31a, address 10.0.0.7, token shown");
  EXPECT_EQ(log[0].name + log[0].role, "") << "nobody said who it was";
}

TEST_F(Access, AJobIsForWhoBeganItAndForOperators) {
  report_some();
  const FetchReply fetched = fetch(request_for(*pupil_));
  ASSERT_TRUE(fetched.distribution) << fetched.message;
  const Caller anna = named("anna", AccessRole::Reader), ben = named("ben", AccessRole::Reader);
  const AdminPage begun =
      ask(anna, AdminVerb::ExportConfigurations, fetched.distribution->id.hex());
  ASSERT_EQ(begun.status, AdminStatus::Ok) << begun.message;
  const std::string job = std::get<Job>(begun.rows[0]).id;
  for (const AdminVerb verb : {AdminVerb::ShowJob, AdminVerb::JobRows, AdminVerb::CancelJob})
    EXPECT_EQ(ask(ben, verb, job).message.substr(0, 24), "ben (role reader) may no");
  EXPECT_EQ(ask(anna, AdminVerb::ShowJob, job).status, AdminStatus::Ok);
  EXPECT_EQ(ask(anna, AdminVerb::CancelJob, job).status, AdminStatus::Ok);
  EXPECT_EQ(ask(named("otto", AccessRole::Operator), AdminVerb::CancelJob, job).status,
            AdminStatus::Ok);
}

TEST_F(Access, ANarrowedOperatorHasNothingToDoWithJobsOfOthers) {
  const std::string job = begin_held_job(named("otto", AccessRole::Operator));
  const Caller nora = named("nora", AccessRole::Operator, {"shelf"});
  for (const AdminVerb verb : {AdminVerb::ShowJob, AdminVerb::JobRows, AdminVerb::CancelJob}) {
    const AdminPage page = ask(nora, verb, job);
    EXPECT_EQ(page.status, AdminStatus::Refused);
    EXPECT_NE(page.message.find("it is not its own, which may be about others; its certificate is "
                                "for tasks shelf"),
              std::string::npos)
        << page.message;
  }
  EXPECT_EQ(state_of(job), JobState::Running);
}

TEST_F(Access, AClientHasSoManyJobsAndIsToldWhenToComeAgain) {
  const Caller otto = named("otto", AccessRole::Operator);
  begin_held_job(otto);
  EXPECT_EQ(ask(otto, AdminVerb::Backup, "second.db").status, AdminStatus::Ok);
  const AdminPage third = ask(otto, AdminVerb::Backup, "third.db");
  EXPECT_EQ(third.status, AdminStatus::Failed) << "for now";
  EXPECT_GT(third.retry_after.count(), 0);
  EXPECT_NE(third.message.find("2 jobs that have not ended"), std::string::npos) << third.message;
  EXPECT_EQ(ask(named("olga", AccessRole::Operator), AdminVerb::Backup, "other.db").status,
            AdminStatus::Ok);
}

TEST_F(Access, NarrowedToATaskNothingTellsTheNamesOfOthers) {
  const std::vector<Attempt> attempts = report_some();
  const Caller anna = named("anna", AccessRole::Operator, {"sh*"});
  EXPECT_EQ(rows<TaskSummary>(ask(anna, AdminVerb::ListTasks)).size(), 1U);
  for (const PathSummary& path : rows<PathSummary>(ask(anna, AdminVerb::ListPaths)))
    EXPECT_EQ(path.task, "shelf");
  for (const AttemptSummary& one : rows<AttemptSummary>(ask(anna, AdminVerb::ListAttempts)))
    EXPECT_EQ(one.task, "shelf");
  AdminRequest request;  // of an export the second page, after the robots
  request.verb = AdminVerb::ExportPaths;
  request.cursor = "attempts ";
  const auto exported = rows<Attempt>(ask_for(anna, request));
  EXPECT_EQ(exported.size(), 2U);
  for (const Attempt& attempt : exported)
    EXPECT_EQ(attempt.task, "shelf");
  EXPECT_EQ(rows<PathSummary>(ask(anna, AdminVerb::ListPaths)).size(), 2U);
  EXPECT_EQ(rows<AttemptSummary>(ask(anna, AdminVerb::ListAttempts)).size(), 2U);
  const AdminPage there = ask(anna, AdminVerb::ShowTask, "bin");
  const AdminPage nowhere = ask(anna, AdminVerb::ShowTask, "box");
  EXPECT_EQ(there.message,
            "anna (role operator) may not ask about task 'bin': its certificate is "
            "for tasks sh*");
  EXPECT_EQ(nowhere.status, there.status) << "nobody learns whether there is one";
  EXPECT_EQ(ask(anna, AdminVerb::ListPaths, "", "bin").status, AdminStatus::Refused);
  EXPECT_EQ(ask(anna, AdminVerb::ShowPath, attempts[1].report_uuid.text()).status,
            AdminStatus::NotFound);
  EXPECT_EQ(ask(anna, AdminVerb::ShowPath, attempts[0].report_uuid.text()).status, AdminStatus::Ok);
  EXPECT_EQ(ask(anna, AdminVerb::RetirePath, attempts[1].report_uuid.text()).status,
            AdminStatus::NotFound);
  EXPECT_EQ(ask(anna, AdminVerb::ResetTask, "bin").status, AdminStatus::Refused);
  EXPECT_EQ(real_store_->find_task("bin")->paths, 1U);
  ASSERT_TRUE(real_store_->reset_task("bin"));
  EXPECT_EQ(ask(anna, AdminVerb::RestorePath, "", "", "teacher").status, AdminStatus::Refused);
  EXPECT_EQ(ask(anna, AdminVerb::RestorePath, "", "bin").status, AdminStatus::Refused);
  EXPECT_EQ(real_store_->find_task("bin")->paths, 0U);
  EXPECT_EQ(ask(anna, AdminVerb::ShowTask, "shel").message, "no task 'shel'")
      << "a near name may be one of others";
  EXPECT_EQ(ask(anna, AdminVerb::ListAudit).status, AdminStatus::Refused);
}

TEST_F(Access, NarrowedToATaskReportsOfOthersThatBeginAlikeAreNoReports) {
  std::vector<Attempt> attempts = {fleet::solved(*teacher_, "bin", 1),
                                   fleet::solved(*teacher_, "bin", 2)};
  attempts[0].report_uuid = Uuid::parse("0abcdef0-0000-4000-8000-000000000001").value();
  attempts[1].report_uuid = Uuid::parse("0abcdef0-0000-4000-8000-000000000002").value();
  report(attempts);
  const std::string prefix = "0abcdef0";
  const AdminPage none =
      ask(named("anna", AccessRole::Reader, {"sh*"}), AdminVerb::ShowPath, prefix);
  EXPECT_EQ(none.status, AdminStatus::NotFound);
  EXPECT_EQ(none.message, "no report '0abcdef0'");
  const AdminPage several = ask(named("otto", AccessRole::Reader), AdminVerb::ShowPath, prefix);
  EXPECT_NE(several.message.find("several reports begin with"), std::string::npos)
      << several.message;
}

TEST_F(Access, NarrowedToARobotOnlyThatOneIsSeen) {
  const std::vector<Attempt> attempts = report_some();
  const Caller anna = named("anna", AccessRole::Operator, {}, {"pupil"});
  const auto robots = rows<RobotSummary>(ask(anna, AdminVerb::ListRobots));
  ASSERT_EQ(robots.size(), 1U);
  EXPECT_EQ(robots[0].label, "pupil");
  const auto tasks = rows<TaskSummary>(ask(anna, AdminVerb::ListTasks));
  ASSERT_EQ(tasks.size(), 1U) << "of the task that is another robot's alone not even the name";
  ASSERT_EQ(tasks[0].robots.size(), 1U);
  EXPECT_EQ(tasks[0].paths, 1U);
  EXPECT_EQ(rows<PathSummary>(ask(anna, AdminVerb::ListPaths)).size(), 1U);
  EXPECT_EQ(rows<ExportedRobot>(ask(anna, AdminVerb::ExportPaths)).size(), 1U);
  AdminRequest request;
  request.verb = AdminVerb::ExportPaths;
  request.cursor = "attempts ";
  EXPECT_EQ(rows<Attempt>(ask_for(anna, request)).size(), 1U);
  for (const std::string& name : {std::string("teacher"), teacher_->digest.hex().substr(0, 8)}) {
    EXPECT_EQ(ask(anna, AdminVerb::ShowRobot, name).status, AdminStatus::Refused) << name;
    EXPECT_EQ(ask(anna, AdminVerb::ListPaths, "", "", name).status, AdminStatus::Refused) << name;
  }
  EXPECT_EQ(ask(anna, AdminVerb::ShowRobot, pupil_->digest.hex()).status, AdminStatus::Ok);
  EXPECT_EQ(ask(anna, AdminVerb::RetirePath, attempts[0].report_uuid.text()).status,
            AdminStatus::NotFound);
  EXPECT_EQ(ask(anna, AdminVerb::RetirePath, attempts[2].report_uuid.text()).status,
            AdminStatus::Ok);
  const FetchReply fetched = fetch(request_for(*teacher_));
  ASSERT_TRUE(fetched.distribution) << fetched.message;
  EXPECT_EQ(ask(anna, AdminVerb::ShowDistribution, fetched.distribution->id.hex()).status,
            AdminStatus::NotFound);
  EXPECT_EQ(ask(anna, AdminVerb::EvictDistribution, fetched.distribution->id.hex()).status,
            AdminStatus::NotFound);
  EXPECT_TRUE(rows<DistributionSummary>(ask(anna, AdminVerb::ListDistributions)).empty());
}

TEST_F(Access, AStatusForANarrowedCertificateTellsNoNames) {
  fetch(request_for(*teacher_));  // there is nothing
  FetchRequest wrong = request_for(*teacher_);
  wrong.profile = "secret_profile";
  fetch(wrong);
  const auto words = [&](const Caller& caller) {
    std::string text;
    for (const auto& status : rows<ServerStatus>(ask(caller, AdminVerb::Status)))
      for (const TroubleCount& trouble : status.troubles)
        text += trouble.last;
    return text;
  };
  EXPECT_NE(words(named("otto", AccessRole::Reader)).find("secret_profile"), std::string::npos);
  EXPECT_EQ(words(named("r", AccessRole::Robot, {"bin"})), "");
}

TEST_F(Access, ADistributionShownToSomeRobotsDoesNotNameTheOthersItIsMadeOf) {
  report_some();
  FetchRequest request = request_for(*pupil_);
  request.task = "shelf";
  const FetchReply fetched = fetch(request);
  ASSERT_TRUE(fetched.distribution) << fetched.message;
  const Caller anna = named("anna", AccessRole::Reader, {}, {"pupil"});
  const std::string id = fetched.distribution->id.hex();
  const auto shown = rows<Distribution>(ask(anna, AdminVerb::ShowDistribution, id));
  const auto explained = rows<Explanation>(ask(anna, AdminVerb::ExplainDistribution, id));
  ASSERT_EQ(shown.size() + explained.size(), 2U);
  for (const Distribution& each : {shown[0], explained[0].distribution}) {
    ASSERT_EQ(each.sources.size(), 2U);
    for (const Source& source : each.sources) {
      const bool is_own = source.robot == pupil_->digest;
      EXPECT_EQ(source.label, is_own ? "pupil" : access::kOtherRobot);
      EXPECT_TRUE(is_own || source.robot == Digest());
    }
  }
  for (const auto& now : explained[0].experience)
    EXPECT_EQ(now.label, "pupil");
  const Caller ben = named("ben", AccessRole::Reader);
  const auto whole = rows<Distribution>(ask(ben, AdminVerb::ShowDistribution, id));
  ASSERT_EQ(whole.size(), 1U);
  for (const Source& source : whole[0].sources)
    EXPECT_NE(source.label, access::kOtherRobot);
  EXPECT_EQ(rows<Explanation>(ask(ben, AdminVerb::ExplainDistribution, id)).at(0).experience.size(),
            2U);
}

}  // namespace
}  // namespace kinship::service::access_test
