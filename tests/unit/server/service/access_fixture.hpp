#pragma once

#include <memory>
#include <semaphore>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service {

/// A service whose administrators are named, with paths of two tasks and robots.
class AccessFixture : public ServiceFixture {
 protected:
  using Lines = std::vector<std::string>;

  AccessFixture() {
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
  AdminPage ask_for(const Caller& caller, const AdminRequest& request,
                    const std::string& request_key = {}) {
    std::promise<AdminPage> page;
    service_->administration().administer(
        request, request_key, [&](const AdminPage& p) { page.set_value(p); }, caller);
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

  /// A backup that runs until let_go() or the end of the test. \return its id.
  std::string begin_held_job(const Caller& caller, const std::string& name = "held.db") {
    troubled_->on_backup = [this] {
      begun_.release();
      may_go_on_.acquire();
      may_go_on_.release();  // those after it
    };
    const AdminPage page = ask(caller, AdminVerb::Backup, name);
    EXPECT_EQ(page.status, AdminStatus::Ok) << page.message;
    begun_.acquire();
    return std::get<Job>(page.rows.at(0)).id;
  }
  void let_go() {
    if (!std::exchange(is_let_go_, true))
      may_go_on_.release();
  }
  JobState state_of(const std::string& job) {
    AdminRequest show = fleet::question(AdminVerb::ShowJob, job);
    return std::get<Job>(administer(show).rows.at(0)).state;
  }
  /// When it has ended; the clock stands still.
  Job end_of(const std::string& job) {
    AdminRequest wait = fleet::question(AdminVerb::ShowJob, job);
    wait.deadline = std::chrono::hours(1);
    return std::get<Job>(administer(wait).rows.at(0));
  }
  void TearDown() override {
    let_go();
    ServiceFixture::TearDown();
  }

  std::shared_ptr<const runtime::Robot> teacher_, pupil_;

 private:
  std::counting_semaphore<> begun_{0}, may_go_on_{0};
  bool is_let_go_ = false;
};

}  // namespace kinship::service
