#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/enum_text.hpp"
#include "server/service/service.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service {

/// The real fit behind a gate, so that a test decides when it goes on; counts calls.
class GatedFit {
 public:
  void close() { set_permits(0); }
  void open() { set_permits(kAlways); }
  void let_one_pass() { set_permits(1); }
  /// Called by each fit before it begins; may throw.
  void set_trouble(std::function<void()> trouble) {
    const std::lock_guard lock(mutex_);
    trouble_ = std::move(trouble);
  }
  /// Called by each fit when it has its outcome.
  void set_afterwards(std::function<void()> afterwards) {
    const std::lock_guard lock(mutex_);
    afterwards_ = std::move(afterwards);
  }
  void wait_for_calls(int calls) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return calls_ >= calls; });
  }
  int calls() const {
    const std::lock_guard lock(mutex_);
    return calls_;
  }
  fitting::FitOutcome operator()(const fitting::DistributionKey& key,
                                 const fitting::FitContext& context, const std::stop_token& stop) {
    {
      std::unique_lock lock(mutex_);
      ++calls_;
      changed_.notify_all();
      changed_.wait(lock, [this] { return permits_ > 0; });
      if (trouble_)
        trouble_();
      if (permits_ != kAlways)
        --permits_;
    }
    fitting::FitOutcome outcome = fit_distribution(key, context, stop);
    std::function<void()> afterwards;
    {
      const std::lock_guard lock(mutex_);
      afterwards = afterwards_;
    }
    if (afterwards)
      afterwards();
    return outcome;
  }

 private:
  static constexpr int kAlways = std::numeric_limits<int>::max();
  void set_permits(int permits) {
    {
      const std::lock_guard lock(mutex_);
      permits_ = permits;
    }
    changed_.notify_all();
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int permits_ = kAlways;
  std::function<void()> trouble_, afterwards_;
  int calls_ = 0;
};

/// A service on a real store in a folder of its own, with a clock that the test sets and calls
/// that wait for their answer. Teacher, pupil and dwarf are registered.
class ServiceFixture : public testing::Test {
 public:
  ServiceFixture() { start(); }
  ServiceFixture(const ServiceFixture&) = delete;
  ServiceFixture& operator=(const ServiceFixture&) = delete;

 protected:
  /// Ends the service while all that its threads call is still there, also what derived fixtures
  /// have.
  void TearDown() override {
    gate_.open();
    service_.reset();
  }
  /// Starts the service, again if it runs already.
  void start() {
    service_.reset();
    context_.reset();
    registry_.reset();
    real_store_.reset();
    std::unique_ptr<store::Store> store = store::open_sqlite_store(directory_ / "fleet.db");
    if (may_trouble_store_) {
      real_store_ = std::move(store);
      auto troubled = std::make_unique<store::TroubledStore>(*real_store_);
      troubled->takes_reports = true;
      troubled_ = troubled.get();
      store = std::move(troubled);
    }
    registry_ = std::make_unique<runtime::RobotRegistry>(*store);
    context_ = std::make_unique<fitting::FitContext>(
        fitting::FitContext{.store = *store, .robots = *registry_, .clock = clock_});
    ServiceOptions options;
    options.version = "1.2.3";
    options.fit_threads = fit_threads_;
    options.fit_queue = fit_queue_;
    options.short_task_queue = short_task_queue_;
    options.clock = clock_;
    options.fit = [this](const fitting::DistributionKey& key, const std::stop_token& stop) {
      return gate_(key, *context_, stop);
    };
    options.log = [this](std::string_view line) {
      const std::lock_guard lock(log_mutex_);
      log_.emplace_back(line);
    };
    options.on_event = [this](const Event& event) {
      const std::lock_guard lock(log_mutex_);
      events_ += std::string(to_text(event.kind)) + '|' + event.task + '|' + event.robot + '|' +
                 event.text + '\n';
      event_told_.notify_all();
    };
    if (adjust_)
      adjust_(options);
    service_ = std::make_unique<Service>(std::move(store), std::move(options));
    for (const RobotDescription& robot : {fleet::teacher(), fleet::pupil(), fleet::dwarf()})
      register_robot(robot);
  }

  void advance(std::chrono::milliseconds time) { time_ms_ += time.count(); }

  RegisterReply register_robot(const RobotDescription& description) {
    std::promise<RegisterReply> reply;
    service_->registration().register_robot(description,
                                            [&](const RegisterReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }
  ReportReply report(const std::vector<Attempt>& attempts) {
    std::promise<ReportReply> reply;
    service_->reports().report({attempts, {}}, [&](const ReportReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }
  std::future<FetchReply> begin_fetch(const FetchRequest& request, const std::string& waiter) {
    const auto reply = std::make_shared<std::promise<FetchReply>>();
    std::future<FetchReply> future = reply->get_future();
    service_->fetches().fetch(request, waiter,
                              [reply](const FetchReply& r) { reply->set_value(r); });
    return future;
  }
  FetchReply fetch(const FetchRequest& request) { return begin_fetch(request, "one").get(); }
  AdminPage administer(AdminRequest request) {
    std::promise<AdminPage> page;
    service_->administration().administer(
        std::move(request), "", [&](const AdminPage& p) { page.set_value(p); },
        fleet::caller_here());
    return page.get_future().get();
  }

  static FetchRequest request_for(const runtime::Robot& robot) {
    FetchRequest request;
    request.task = "shelf";
    request.robot = robot.digest;
    request.deadline = std::chrono::seconds(30);  // of the clock that stands still
    return request;
  }
  std::string log() {
    const std::lock_guard lock(log_mutex_);
    std::string all;
    for (const std::string& line : log_)
      all += line + '\n';
    return all;
  }

  /// Whether an event with this text is told: after the reply that it is about, perhaps.
  bool is_told(const std::string& text) {
    std::unique_lock lock(log_mutex_);
    return event_told_.wait_for(lock, std::chrono::seconds(60),
                                [&] { return events_.find(text) != std::string::npos; });
  }

  /// Lines of kind|task|robot|text.
  std::string events() {
    const std::lock_guard lock(log_mutex_);
    return events_;
  }

  test::TemporaryDirectory directory_;
  std::atomic<std::int64_t> time_ms_{1'700'000'000'000};
  runtime::Clock clock_{
      .now =
          [this] {
            return std::chrono::steady_clock::time_point(std::chrono::milliseconds(time_ms_));
          },
      .unix_ms = [this] { return time_ms_.load(); }};
  std::size_t fit_threads_ = 2, fit_queue_ = 64, short_task_queue_ = 1024;
  /// Whether the service has a store that may be troubled, between itself and the real one.
  bool may_trouble_store_ = false;
  std::unique_ptr<store::Store> real_store_;
  store::TroubledStore* troubled_ = nullptr;
  std::function<void(ServiceOptions&)> adjust_;  ///< of what start() would use; may be empty
  GatedFit gate_;
  std::mutex log_mutex_;
  std::vector<std::string> log_;  // guarded by log_mutex_
  std::string events_;            // guarded by log_mutex_
  std::condition_variable event_told_;
  std::unique_ptr<runtime::RobotRegistry> registry_;
  std::unique_ptr<fitting::FitContext> context_;
  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  const runtime::Robot pupil_ = fleet::robot_of(fleet::pupil());
  const runtime::Robot dwarf_ = fleet::robot_of(fleet::dwarf());
  std::unique_ptr<Service> service_;  // last: its threads use all of the above
};

}  // namespace kinship::service
