#include "server/http/listener.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "proto/types/failure.hpp"
#include "tests/support/http_connection.hpp"

namespace kinship::http::listener_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::HttpConnection;
using Clock = std::chrono::steady_clock;

/// A listener that answers /now at once, /later when the test says so, /stream without an end.
class ListenerTest : public testing::Test {
 protected:
  ListenerTest() { start({}); }

  void start(const Limits& limits) {
    listener_.reset();
    Port port({.address = "127.0.0.1", .port = 0}, {"a test", "--test"});
    url_ = port.url();
    listener_ = std::make_unique<Listener>(
        std::move(port),
        [this](const Request& request, const Answer& answer) { handle(request, answer); }, limits);
  }

  void handle(const Request& request, const Answer& answer) {
    if (request.path == "/ill")
      throw std::runtime_error("the store is on fire");
    if (request.path == "/later")
      return later_.set_value(answer);
    if (request.path == "/stream")
      return answer({.type = "text/event-stream",
                     .stream = [this](const Send& send) { stream_.set_value(send); }});
    answer(text_reply(200, request.method + ' ' + request.path + ' ' + request.body + ' ' +
                               std::to_string(++answers_)));
  }

  std::string ask(const std::string& request) const {
    const HttpConnection connection(url_);
    connection.send(request);
    return connection.read();
  }
  std::string get(const std::string& target = "/now") const {
    return ask("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  std::unique_ptr<HttpConnection> begin_stream() {
    auto reader = std::make_unique<HttpConnection>(url_);
    reader->send("GET /stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return reader;
  }

  std::string url_;
  std::atomic<int> answers_ = 0;
  std::promise<Answer> later_;
  std::promise<Send> stream_;
  std::unique_ptr<Listener> listener_;
};

TEST_F(ListenerTest, AnswersAndCloses) {
  const std::string reply = get("/now?x=1");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_NE(reply.find("Content-Type: text/plain; charset=utf-8\r\n"), std::string::npos) << reply;
  EXPECT_NE(reply.find("Connection: close\r\n"), std::string::npos) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\nGET /now  1\n")) << reply;
}

TEST_F(ListenerTest, AConnectionMayAskSeveralTimes) {
  start({.requests = 3});
  const HttpConnection connection(url_);
  const std::string one = "GET /now HTTP/1.1\r\nHost: localhost\r\n\r\n";
  ASSERT_TRUE(connection.send(one + one + one + one));
  const std::string replies = connection.read();
  EXPECT_NE(replies.find("GET /now  2\n"), std::string::npos) << replies;
  EXPECT_TRUE(replies.ends_with("GET /now  3\n")) << replies;
}

TEST_F(ListenerTest, HeadHasNoBody) {
  const std::string reply = ask("HEAD /now HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_NE(reply.find("Content-Length: 13\r\n"), std::string::npos) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\n")) << reply;
}

TEST_F(ListenerTest, TakesABodyUpToItsLimit) {
  const std::string post = "POST /now HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n\r\nbody";
  EXPECT_TRUE(ask(post).starts_with("HTTP/1.1 413 "));
  start({.body_bytes = 4});
  EXPECT_TRUE(ask(post).ends_with("POST /now body 1\n"));
}

TEST_F(ListenerTest, AnswersForItsOwnNamesOnly) {
  start({.hosts = {"cell.example"}, .host_option = "--test-host"});
  const auto reply = [&](const std::string& hosts) {
    return ask("GET /now HTTP/1.1\r\n" + hosts + "\r\n");
  };
  const auto status = [&](const std::string& hosts) { return reply(hosts).substr(9, 3); };
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  for (const std::string host :
       {"127.0.0.1:9464", "192.0.2.7", "[::1]:9464", "localhost", "LOCALHOST:1", "Cell.Example:80"})
    EXPECT_EQ(status("Host: " + host + "\r\n"), "200") << host;
  EXPECT_EQ(status("Host: " + std::string(name) + ":9464\r\n"), "200");
  EXPECT_EQ(status(""), "200") << "no browser leaves it out";
  for (const std::string host : {"evil.example:9464", "", "cell.example.evil.example", "[::1",
                                 "localhost@evil.example", "127.0.0.1.evil.example"})
    EXPECT_EQ(status("Host: " + host + "\r\n"), "421") << host;
  EXPECT_EQ(status("Host: localhost\r\nHost: evil.example\r\n"), "421");
  EXPECT_TRUE(reply("Host: evil.example\r\n").ends_with("kinshipd --test-host NAME serves it\n"));
}

TEST_F(ListenerTest, SaysWhyAHandlerFailedAndGoesOn) {
  const std::string reply = get("/ill");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 503 ")) << reply;
  EXPECT_TRUE(reply.ends_with("the store is on fire\n")) << reply;
  EXPECT_TRUE(get().starts_with("HTTP/1.1 200 "));
}

TEST_F(ListenerTest, GarbageIsToldSo) {
  EXPECT_TRUE(ask("\x16\x03\x01\x02\x01 hello\r\n\r\n").starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(ask("GET /now HTTP/9.9\r\n\r\n").starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(get("/%zz").starts_with("HTTP/1.1 400 "));
  const std::string large = "GET /now HTTP/1.1\r\nX: " + std::string(10'000, 'x') + "\r\n\r\n";
  EXPECT_TRUE(ask(large).starts_with("HTTP/1.1 431 "));
  EXPECT_TRUE(get().starts_with("HTTP/1.1 200 "));
}

TEST_F(ListenerTest, AnswersLaterFromAnotherThread) {
  const HttpConnection connection(url_);
  ASSERT_TRUE(connection.send("GET /later HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  const Answer answer = later_.get_future().get();
  EXPECT_TRUE(get().ends_with(" 1\n")) << "nobody waits for it";
  answer(text_reply(200, "late"));
  answer(text_reply(200, "again"));
  EXPECT_TRUE(connection.read().ends_with("\r\n\r\nlate\n"));
}

TEST_F(ListenerTest, AnAnswerAfterItsEndDoesNothing) {
  const HttpConnection connection(url_);
  ASSERT_TRUE(connection.send("GET /later HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  const Answer answer = later_.get_future().get();
  listener_.reset();
  answer(text_reply(200, "too late"));
  EXPECT_EQ(connection.read(), "");
}

TEST_F(ListenerTest, AStreamIsSentPartByPart) {
  const auto reader = begin_stream();
  const Send send = stream_.get_future().get();
  EXPECT_TRUE(send(std::make_shared<const std::string>("one ")));
  EXPECT_TRUE(send(std::make_shared<const std::string>("two\n")));
  const std::string text = reader->read_until("two\n");
  EXPECT_NE(text.find("Content-Type: text/event-stream\r\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("Content-Length"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\r\n\r\none two\n")) << text;
  listener_.reset();
  EXPECT_FALSE(send(std::make_shared<const std::string>("three")));
  EXPECT_EQ(reader->read(), "");
}

TEST_F(ListenerTest, AStreamWithASlowReaderIsDropped) {
  start({.stream_bytes = 1U << 20U, .request_time = seconds(60)});
  const auto reader = begin_stream();
  const Send send = stream_.get_future().get();
  const auto part = std::make_shared<const std::string>(1U << 18U, 'x');
  std::size_t sent = 0;
  while (sent < 1000 && send(part)) {
    ++sent;
    EXPECT_TRUE(get().starts_with("HTTP/1.1 200 ")) << "others wait for it";
  }
  EXPECT_LT(sent, 1000U);  // what the sockets hold, and a megabyte
}

TEST_F(ListenerTest, AStreamWithoutAReaderIsNoticed) {
  auto reader = begin_stream();
  const Send send = stream_.get_future().get();
  ASSERT_TRUE(send(std::make_shared<const std::string>("one")));
  reader->read_until("one");
  reader.reset();
  const auto end = Clock::now() + seconds(20);
  while (send(std::make_shared<const std::string>("more")) && Clock::now() < end)
    get();
  EXPECT_LT(Clock::now(), end);
}

TEST_F(ListenerTest, ASlowRequestIsCutOffAndKeepsNobodyWaiting) {
  start({.request_time = milliseconds(300)});
  const HttpConnection slow(url_);
  const auto began = Clock::now();
  ASSERT_TRUE(slow.send("GET /n"));
  EXPECT_TRUE(get().ends_with(" 1\n"));
  EXPECT_EQ(slow.read(), "");
  const auto took = Clock::now() - began;
  EXPECT_GE(took, milliseconds(250));
  EXPECT_LT(took, seconds(10));
}

TEST_F(ListenerTest, OneConnectionMoreEndsTheOldestWithoutAStream) {
  start({.connections = 3, .request_time = seconds(60)});
  const auto reader = begin_stream();
  const Send send = stream_.get_future().get();
  std::vector<std::unique_ptr<HttpConnection>> held;
  for (int i = 0; i < 2; ++i)
    held.push_back(std::make_unique<HttpConnection>(url_));
  EXPECT_TRUE(get().ends_with(" 1\n"));
  EXPECT_EQ(held[0]->read(), "");
  ASSERT_TRUE(held[1]->send("GET /now HTTP/1.0\r\n\r\n"));
  EXPECT_TRUE(held[1]->read().ends_with(" 2\n"));
  EXPECT_TRUE(send(std::make_shared<const std::string>("still here")));
  EXPECT_TRUE(reader->read_until("still here").ends_with("still here"));
}

TEST_F(ListenerTest, AThousandConnectionsLeaveOneThatAsksItsAnswer) {
  start({.connections = 64, .request_time = seconds(60)});
  std::vector<std::unique_ptr<HttpConnection>> held;
  for (int i = 0; i < 1000; ++i)
    held.push_back(std::make_unique<HttpConnection>(url_));
  EXPECT_TRUE(get().ends_with(" 1\n"));
  EXPECT_EQ(held.front()->read(), "");
}

TEST_F(ListenerTest, EndsWithConnectionsOpen) {
  const HttpConnection silent(url_);
  listener_.reset();
  EXPECT_EQ(silent.read(), "");
  EXPECT_THROW(HttpConnection again(url_), std::runtime_error);
}

TEST(Port, SaysWhyItCannotBeHad) {
  const PortUse use{"metrics", "--metrics"};
  const Port first({.address = "127.0.0.1", .port = 0}, use);
  const Address taken = first.address();
  EXPECT_EQ(first.url(), "http://" + to_text(taken));
  try {
    const Port second(taken, use);
    FAIL() << "two have one port";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.what(), "metrics cannot be served at " + to_text(taken) +
                                  " (--metrics): Address already in use");
  }
  EXPECT_THROW(Port({.address = "192.0.2.1", .port = 9464}, use), Failure);  // of documents
}

}  // namespace
}  // namespace kinship::http::listener_test
