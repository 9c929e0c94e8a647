#include "server/console/console.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <optional>

#include "proto/json/admin_rows_json.hpp"
#include "server/store/open_store.hpp"
#include "tests/support/http_connection.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::console::console_test {
namespace {

using test::HttpConnection;

constexpr const char* kToken = "0123456789abcdef";

/// A console of a service with an empty store.
class ConsoleTest : public testing::Test {
 protected:
  void SetUp() override { start(false); }
  void TearDown() override {
    console_.reset();
    service_.shutdown();
  }

  void start(bool is_admin) {
    console_.reset();
    http::Port port({.address = "127.0.0.1", .port = 0}, {"a test", "--test"});
    url_ = port.url();
    const std::string number = std::to_string(port.address().port);
    fields_ = "Host: 127.0.0.1:" + number + "\r\nCookie: kinship-console-" + number + '=' + kToken +
              "\r\n";
    console_.emplace(
        std::move(port), service_, broadcast_,
        ConsoleOptions{.token = kToken,
                       .is_admin = is_admin,
                       .hosts = {},
                       .to_json = [this](const service::AdminRow& row) { return text_of(row); }});
  }

  /// Of a status alone; waits while the test holds it.
  std::string text_of(const service::AdminRow& row) {
    {
      std::unique_lock lock(mutex_);
      is_reached_ = true;
      changed_.notify_all();
      changed_.wait(lock, [this] { return !is_held_; });
    }
    const auto* const status = std::get_if<ServerStatus>(&row);
    return status != nullptr ? json::to_json(*status) : "{}";
  }
  void set_held(bool is_held) {
    const std::lock_guard lock(mutex_);
    is_held_ = is_held;
    is_reached_ = false;
    changed_.notify_all();
  }
  void wait_until_reached() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_reached_; });
  }

  std::string ask(const std::string& line, const std::string& more = "",
                  const std::string& body = "") const {
    const HttpConnection connection(url_);
    connection.send(line + " HTTP/1.1\r\n" + fields_ + more +
                    "Connection: close\r\nContent-Length: " + std::to_string(body.size()) +
                    "\r\n\r\n" + body);
    return connection.read();
  }
  std::string post(const std::string& verb, const std::string& body,
                   const std::string& type = "application/json") const {
    return ask("POST /api/rows/" + verb, "Origin: " + url_ + "\r\nContent-Type: " + type + "\r\n",
               body);
  }
  static std::string status(const std::string& reply) { return reply.substr(9, 3); }

  static service::ServiceOptions options_with(Broadcast& broadcast) {
    service::ServiceOptions options;
    options.on_event = [&broadcast](const Event& event) { broadcast.publish(event); };
    return options;
  }

  std::mutex mutex_;  // guards the next three
  std::condition_variable changed_;
  bool is_held_ = false, is_reached_ = false;
  test::TemporaryDirectory folder_;
  Broadcast broadcast_;
  service::Service service_{store::open_store((folder_.path() / "store.db").string(), {}),
                            options_with(broadcast_)};
  std::string url_, fields_;
  std::optional<Console> console_;
};

TEST_F(ConsoleTest, EveryPageIsTheShellWithItsScripts) {
  for (const char* const path : {"/", "/robots/panda", "/tasks/a%2Fb", "/nowhere/at/all"}) {
    const std::string reply = ask(std::string("GET ") + path);
    EXPECT_EQ(status(reply), "200") << path;
    EXPECT_NE(reply.find("Content-Security-Policy: default-src 'self'; "), std::string::npos);
    EXPECT_NE(reply.find("data-admin=\"no\""), std::string::npos);
    const std::size_t script = reply.find("/assets/console.js?v=");
    ASSERT_NE(script, std::string::npos) << reply;
    const std::string asset = ask("GET " + reply.substr(script, reply.find('"', script) - script));
    EXPECT_NE(asset.find("Content-Type: text/javascript"), std::string::npos);
    EXPECT_NE(asset.find("immutable"), std::string::npos);
  }
  EXPECT_EQ(status(ask("GET /assets/no.js")), "404");
}

TEST_F(ConsoleTest, WhatIsLargeComesPackedToThoseWhoReadIt) {
  const auto is_packed = [&](const std::string& path, const std::string& fields) {
    return ask("GET " + path, fields).find("Content-Encoding: gzip\r\n") != std::string::npos;
  };
  const std::string accepts = "Accept-Encoding: gzip, br\r\n";
  for (const char* const path : {"/", "/assets/console.js", "/api/rows/status"}) {
    EXPECT_TRUE(is_packed(path, accepts)) << path;
    EXPECT_FALSE(is_packed(path, "")) << path;
  }
  EXPECT_FALSE(is_packed("/api/figures/slow/24", accepts)) << "less than a packet";
}

TEST_F(ConsoleTest, RowsAreThoseOfTheVerb) {
  const std::string reply = ask("GET /api/rows/status");
  EXPECT_EQ(status(reply), "200");
  EXPECT_NE(reply.find("{\"rows\":[{\"version\""), std::string::npos) << reply;
  EXPECT_NE(ask("GET /api/rows/list_tasks?limit=7").find("{\"rows\":[],\"next_cursor\":\"\""),
            std::string::npos);
  EXPECT_EQ(status(ask("GET /api/rows/show_robot?argument=nobody")), "404");
  EXPECT_EQ(status(ask("GET /api/rows/list_attempts?cursor=wrong")), "400");
  EXPECT_EQ(status(ask("GET /api/rows/no_such_verb")), "404");
  EXPECT_EQ(status(ask("GET /api/rows")), "404");
}

TEST_F(ConsoleTest, TheNetworkWaitsForNoAnswer) {
  set_held(true);
  const HttpConnection waiting(url_);
  waiting.send("GET /api/rows/status HTTP/1.1\r\n" + fields_ + "Connection: close\r\n\r\n");
  wait_until_reached();
  EXPECT_EQ(status(ask("GET /")), "200");
  set_held(false);
  EXPECT_EQ(status(waiting.read()), "200");
}

TEST_F(ConsoleTest, OnlyReadsUnlessItIsAnAdministrators) {
  const std::string confirmed = R"({"argument": "shelf", "confirm": "shelf"})";
  EXPECT_EQ(status(post("reset_task", confirmed)), "403");
  EXPECT_EQ(status(ask("GET /api/rows/reset_task?argument=shelf")), "405");
  start(true);
  EXPECT_EQ(status(ask("GET /api/rows/reset_task?argument=shelf")), "405");
  EXPECT_EQ(status(post("status", confirmed)), "405");
  EXPECT_EQ(status(post("reset_task", R"({"argument": "shelf", "confirm": "shel"})")), "400");
  EXPECT_EQ(status(post("reset_task", R"({"argument": "", "confirm": ""})")), "400");
  EXPECT_EQ(status(post("reset_task", "not JSON")), "400");
  EXPECT_EQ(status(post("reset_task", confirmed, "text/plain")), "400");
  EXPECT_EQ(status(post("reset_task", confirmed)), "404") << "no such task: it reached the service";
}

TEST_F(ConsoleTest, ARenameIsConfirmedByTheNameThatItChanges) {
  const auto rename = [this](const std::string& confirm) {
    return status(post("rename_task",
                       R"({"task": "shelf", "argument": "rack", "confirm": ")" + confirm + "\"}"));
  };
  EXPECT_EQ(rename("shelf"), "403");
  start(true);
  EXPECT_EQ(rename("rack"), "400");
  EXPECT_EQ(rename(""), "400");
  EXPECT_EQ(rename("shelf"), "404") << "no such task: it reached the service";
  EXPECT_EQ(status(post("restore_path", R"({"task": "shelf", "confirm": "shelf"})")), "404");
  EXPECT_EQ(status(post("restore_path", R"({"task": "shelf", "confirm": ""})")), "400");
  EXPECT_EQ(
      status(post("reset_task", R"({"argument": "shelf", "task": "other", "confirm": "other"})")),
      "400")
      << "the verb takes no task beside its argument";
}

TEST_F(ConsoleTest, EventsComeAsTheyHappen) {
  const HttpConnection browser(url_);
  browser.send("GET /api/events HTTP/1.1\r\n" + fields_ + "\r\n");
  EXPECT_NE(browser.read_until("\"receipts\":").find("event: status\ndata: {\"now_ms\":"),
            std::string::npos);
  broadcast_.publish({.kind = EventKind::Fit, .task = "", .robot = "", .text = "fitted"});
  EXPECT_NE(browser.read_until("fitted").find("\"kind\":\"fit\""), std::string::npos);
}

TEST_F(ConsoleTest, FiguresSayWhyThereIsNone) {
  EXPECT_EQ(status(ask("GET /api/figures/task/shelf")), "404");
  EXPECT_EQ(status(ask("GET /api/figures/distribution/0123")), "404");
  EXPECT_EQ(status(ask("GET /api/figures/no_such/kind")), "404");
  EXPECT_NE(ask("GET /api/figures/slow/24").find("\"attempts\":0,\"is_whole\":true"),
            std::string::npos);
  EXPECT_NE(ask("GET /api/figures/savings/x").find("\"pairs\":[]"), std::string::npos);
}

TEST_F(ConsoleTest, EndsWithAnAnswerOutstanding) {
  set_held(true);
  const HttpConnection waiting(url_);
  waiting.send("GET /api/rows/status HTTP/1.1\r\n" + fields_ + "\r\n");
  wait_until_reached();
  console_.reset();
  set_held(false);
  EXPECT_EQ(waiting.read(), "");
}

}  // namespace
}  // namespace kinship::console::console_test
