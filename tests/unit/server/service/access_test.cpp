#include "server/access/access.hpp"

#include "server/access/withheld_sources.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::access_test {
namespace {

/// A service whose administrators are named, with paths of two tasks and robots.
class Access : public ServiceFixture {
 protected:
  Access() {
    may_trouble_store_ = true;
    start();
    teacher_ = find("teacher");
    pupil_ = find("pupil");
  }
  std::shared_ptr<const runtime::Robot> find(const std::string& label) {
    for (const RobotSummary& robot : real_store_->list_robots("", 100).rows)
      if (robot.label == label)
        return registry_->find(robot.robot).value_or_throw();
    return nullptr;
  }
  static Caller named(const std::string& name, AccessRole role, std::vector<std::string> tasks = {},
                      std::vector<std::string> robots = {}) {
    return {name, name, role, std::move(tasks), std::move(robots), false};
  }
  AdminPage ask(const Caller& caller, AdminVerb verb, const std::string& argument = {},
                const std::string& task = {}, const std::string& robot = {}) {
    AdminRequest request;
    request.verb = verb;
    request.argument = argument;
    request.task = task;
    request.robot = robot;
    return ask_for(caller, request);
  }
  AdminPage ask_for(const Caller& caller, const AdminRequest& request) {
    std::promise<AdminPage> page;
    service_->administer(
        request, "", [&](const AdminPage& p) { page.set_value(p); }, caller);
    return page.get_future().get();
  }
  /// The oldest first: "who verb target outcome".
  std::vector<std::string> log_entries() {
    std::vector<std::string> lines;
    for (const AuditEntry& entry : real_store_->list_audit("", "", 1000).rows)
      lines.insert(lines.begin(), entry.name + " " + entry.verb + " " + entry.target + " " +
                                      std::string(to_text(entry.outcome)));
    return lines;
  }
  template <typename Row>
  static std::vector<Row> rows(const AdminPage& page) {
    std::vector<Row> found;
    for (const AdminRow& row : page.rows)
      if (const auto* const one = std::get_if<Row>(&row))
        found.push_back(*one);
    return found;
  }
  /// \return what was reported, in this order: teacher shelf, teacher bin, pupil shelf.
  std::vector<Attempt> report_some() {
    std::vector<Attempt> attempts = {fleet::solved(*teacher_, "shelf", 1),
                                     fleet::solved(*teacher_, "bin", 2),
                                     fleet::solved(*pupil_, "shelf", 3)};
    for (const Receipt& receipt : report(attempts).receipts)
      EXPECT_EQ(receipt.status, ReceiptStatus::Stored) << receipt.message;
    return attempts;
  }

  std::shared_ptr<const runtime::Robot> teacher_, pupil_;
};

using Lines = std::vector<std::string>;

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
  elsewhere.is_local = false;
  EXPECT_EQ(ask(elsewhere, AdminVerb::ListTasks).status, AdminStatus::Ok);
  const AdminPage reset = ask(elsewhere, AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(reset.status, AdminStatus::Refused);
  EXPECT_NE(reset.message.find("--security"), std::string::npos) << reset.message;
  EXPECT_EQ(real_store_->find_task("shelf")->paths, 2U);
  elsewhere.is_local = true;
  EXPECT_EQ(ask(elsewhere, AdminVerb::ResetTask, "shelf").status, AdminStatus::Ok);
  const std::vector<AuditEntry> log = real_store_->list_audit("", "", 10).rows;
  ASSERT_EQ(log.size(), 3U);
  EXPECT_EQ(log[2].client, "0110f31a");
  EXPECT_FALSE(log[2].is_local);
  EXPECT_TRUE(log[0].is_local);
  EXPECT_EQ(log[0].name + log[0].role, "") << "nobody said who it was";
}

TEST_F(Access, ABackupAndACancelledJobAreInTheAuditLogAsBegunAndAsTheyEnded) {
  const Caller otto = named("otto", AccessRole::Operator);
  const AdminPage begun = ask(otto, AdminVerb::Backup, "copy.db");
  ASSERT_EQ(begun.status, AdminStatus::Ok) << begun.message;
  const std::string job = std::get<Job>(begun.rows[0]).id;
  AdminRequest wait;
  wait.verb = AdminVerb::ShowJob;
  wait.argument = job;
  wait.deadline = std::chrono::hours(1);  // of the clock that stands still
  ASSERT_EQ(std::get<Job>(administer(wait).rows[0]).state, JobState::Done);
  EXPECT_EQ(ask(otto, AdminVerb::Backup, "copy.db").status, AdminStatus::Refused);
  EXPECT_EQ(ask(otto, AdminVerb::CancelJob, job).status, AdminStatus::Ok);
  EXPECT_EQ(
      log_entries(),
      (Lines{"otto backup copy.db begun", "otto backup copy.db done", "otto backup copy.db refused",
             "otto cancel_job " + job + " begun", "otto cancel_job " + job + " done"}));
  const auto copy = store::open_sqlite_store(directory_ / "copy.db");
  EXPECT_EQ(copy->list_audit("otto", "", 10).rows.size(), 1U) << "a copy has what was before it";
}

TEST_F(Access, WhatCannotBeKeptInTheAuditLogIsNotDone) {
  troubled_->on_audit = [](const AuditEntry&) {
    throw Failure(ErrorCode::Storage, "no space is left");
  };
  const AdminPage backup = ask(named("otto", AccessRole::Operator), AdminVerb::Backup, "copy.db");
  EXPECT_EQ(backup.status, AdminStatus::Failed);
  EXPECT_EQ(backup.message, "no space is left");
  EXPECT_FALSE(std::filesystem::exists(directory_ / "copy.db"));
}

TEST_F(Access, WhoIsRefusedForEverFillsNoDisk) {
  const Caller reader = named("anna", AccessRole::Reader);
  for (std::uint64_t i = 0; i < AuditTrail::kRefusalsAtOnce + 50; ++i)
    ask(reader, AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(log_entries().size(), AuditTrail::kRefusalsAtOnce);
  advance(std::chrono::seconds(2));
  ask(reader, AdminVerb::ResetTask, "shelf");
  const std::vector<AuditEntry> log = real_store_->list_audit("", "", 1000).rows;
  ASSERT_EQ(log.size(), AuditTrail::kRefusalsAtOnce + 1);
  EXPECT_NE(log[0].message.find("(50 refusals before it were not kept)"), std::string::npos)
      << log[0].message;
}

TEST_F(Access, AChangeThatIsAskedForAgainIsAnsweredAsItWasAndIsInTheLogOnce) {
  AdminRequest rename;
  rename.verb = AdminVerb::RenameRobot;
  rename.robot = "dwarf";
  rename.argument = "giant";
  const auto ask_as = [&](const std::string& request_key) {
    std::promise<AdminPage> page;
    service_->administer(
        rename, request_key, [&](const AdminPage& p) { page.set_value(p); },
        named("root", AccessRole::Admin));
    return page.get_future().get();
  };
  for (int i = 0; i < 2; ++i) {
    const AdminPage page = ask_as("client 1");
    ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
    EXPECT_EQ(std::get<RobotSummary>(page.rows[0]).label, "giant");
  }
  EXPECT_EQ(log_entries(), Lines{"root rename_robot dwarf to giant done"});
  EXPECT_EQ(ask_as("client 2").status, AdminStatus::NotFound) << "another request";
  EXPECT_EQ(ask_as("client 2").status, AdminStatus::NotFound);
  EXPECT_EQ(log_entries().size(), 2U);
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
  EXPECT_EQ(ask(anna, AdminVerb::ListAudit).status, AdminStatus::Refused);
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
  const Caller ben = named("ben", AccessRole::Reader);
  for (const Source& source :
       rows<Distribution>(ask(ben, AdminVerb::ShowDistribution, id)).at(0).sources)
    EXPECT_NE(source.label, access::kOtherRobot);
}

}  // namespace
}  // namespace kinship::service::access_test
