#include "server/app/metrics_listener.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "proto/types/failure.hpp"

namespace kinship::app::metrics_listener_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

/// A connection of a client that waits no longer than a test may take.
class Connection {
 public:
  explicit Connection(const std::string& url) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const std::size_t begin = url.rfind(':') + 1;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(begin))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no connection to " + url);
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  /// All that comes until the other side closes.
  std::string read() const {
    std::string text;
    char part[4096];
    for (ssize_t count = 0; (count = recv(socket_, part, sizeof part, 0)) > 0;)
      text.append(part, static_cast<std::size_t>(count));
    return text;
  }

 private:
  int socket_;
};

class MetricsListenerTest : public testing::Test {
 protected:
  MetricsListenerTest() { start({.page_age = milliseconds(0)}); }

  void start(const MetricsLimits& limits) {
    listener_.reset();
    MetricsPort port({.address = "127.0.0.1", .port = 0});
    url_ = port.url();
    listener_ = std::make_unique<MetricsListener>(
        std::move(port),
        [this]() -> std::string {
          if (is_ill_)
            throw std::runtime_error("the store is on fire");
          return "pages " + std::to_string(++pages_) + "\n";
        },
        limits);
  }
  std::string ask(const std::string& request) const {
    const Connection connection(url_);
    connection.send(request);
    return connection.read();
  }
  std::string get(const std::string& target = "/metrics") const {
    return ask("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }

  std::string url_;
  std::atomic<int> pages_ = 0;
  std::atomic<bool> is_ill_ = false;
  std::unique_ptr<MetricsListener> listener_;
};

TEST_F(MetricsListenerTest, AnswersWithThePageOfNow) {
  const std::string reply = get();
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_NE(reply.find("Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"),
            std::string::npos)
      << reply;
  EXPECT_NE(reply.find("Connection: close\r\n"), std::string::npos) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\npages 1\n")) << reply;
  EXPECT_TRUE(get("/metrics?x=1").ends_with("pages 2\n"));
}

TEST_F(MetricsListenerTest, HeadHasNoBody) {
  const std::string reply = ask("HEAD /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_NE(reply.find("Content-Length: 8\r\n"), std::string::npos) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\n")) << reply;
}

TEST_F(MetricsListenerTest, RefusesWhatIsNotThere) {
  EXPECT_TRUE(get("/").starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(get("/metrics/..").starts_with("HTTP/1.1 404 "));
  const std::string reply = ask("DELETE /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 405 ")) << reply;
  EXPECT_NE(reply.find("Allow: GET, HEAD\r\n"), std::string::npos) << reply;
  EXPECT_EQ(pages_, 0);
}

TEST_F(MetricsListenerTest, AnswersForItsOwnNamesOnly) {
  start({.page_age = milliseconds(0), .hosts = {"cell.example"}});
  const auto status = [&](const std::string& hosts) {
    return ask("GET /metrics HTTP/1.1\r\n" + hosts + "\r\n").substr(9, 3);
  };
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
}

TEST_F(MetricsListenerTest, SaysWhyThereIsNoPageAndGoesOn) {
  is_ill_ = true;
  const std::string reply = get();
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 503 ")) << reply;
  EXPECT_TRUE(reply.ends_with("the store is on fire\n")) << reply;
  is_ill_ = false;
  EXPECT_TRUE(get().starts_with("HTTP/1.1 200 "));
}

TEST_F(MetricsListenerTest, GarbageIsToldSo) {
  EXPECT_TRUE(ask("\x16\x03\x01\x02\x01 hello\r\n\r\n").starts_with("HTTP/1.1 400 "));
  EXPECT_TRUE(ask("GET /metrics HTTP/9.9\r\n\r\n").starts_with("HTTP/1.1 400 "));
  const std::string large = "GET /metrics HTTP/1.1\r\nX: " + std::string(10'000, 'x') + "\r\n\r\n";
  EXPECT_TRUE(ask(large).starts_with("HTTP/1.1 431 "));
  EXPECT_TRUE(get().starts_with("HTTP/1.1 200 "));
}

TEST_F(MetricsListenerTest, WhoIsSlowIsDisconnectedAndKeepsNobodyWaiting) {
  start({.request_time = milliseconds(300), .page_age = milliseconds(0)});
  const Connection slow(url_);
  const auto began = Clock::now();
  ASSERT_TRUE(slow.send("GET /metr"));
  EXPECT_TRUE(get().ends_with("pages 1\n"));
  EXPECT_EQ(slow.read(), "");
  const auto took = Clock::now() - began;
  EXPECT_GE(took, milliseconds(250));
  EXPECT_LT(took, seconds(10));
}

TEST_F(MetricsListenerTest, OneConnectionMoreEndsTheOldest) {
  start({.connections = 3, .request_time = seconds(60), .page_age = milliseconds(0)});
  std::vector<std::unique_ptr<Connection>> held;
  for (int i = 0; i < 3; ++i)
    held.push_back(std::make_unique<Connection>(url_));
  EXPECT_TRUE(get().ends_with("pages 1\n"));
  EXPECT_EQ(held[0]->read(), "");
  ASSERT_TRUE(held[2]->send("GET /metrics HTTP/1.0\r\n\r\n"));
  EXPECT_TRUE(held[2]->read().ends_with("pages 2\n"));
}

TEST_F(MetricsListenerTest, MakesNoPageForEverybodyWhoAsksAtOnce) {
  start({.page_age = seconds(60)});
  for (int i = 0; i < 5; ++i)
    EXPECT_TRUE(get().ends_with("pages 1\n"));
}

TEST_F(MetricsListenerTest, EndsWithConnectionsOpen) {
  const Connection silent(url_);
  listener_.reset();
  EXPECT_EQ(silent.read(), "");
  EXPECT_THROW(Connection again(url_), std::runtime_error);
}

TEST(MetricsPort, SaysWhyItCannotBeHad) {
  const MetricsPort first({.address = "127.0.0.1", .port = 0});
  const std::string url = first.url();
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  try {
    const MetricsPort second({.address = "127.0.0.1", .port = port});
    FAIL() << "two have one port";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.what(), "metrics cannot be served at 127.0.0.1:" + std::to_string(port) +
                                  " (--metrics): Address already in use");
  }
  EXPECT_THROW(MetricsPort({.address = "192.0.2.1", .port = 9464}), Failure);  // of documents
}

TEST(MetricsAddress, IsAnAddressAndAPort) {
  const auto text = [](const char* from) { return to_text(read_metrics_address(from).value()); };
  for (const char* const good : {"127.0.0.1:9464", "0.0.0.0:0", "[::1]:65535"})
    EXPECT_EQ(text(good), good);
  for (const char* const bad :
       {"", "9464", ":9464", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1",
        "127.0.0.1:94 ", "localhost:9464", "::1:9464", "[::1]", "[127.0.0.1]:1", "1.2.3:4"}) {
    const auto read = read_metrics_address(bad);
    ASSERT_FALSE(read) << bad;
    EXPECT_TRUE(read.error().message.starts_with("'" + std::string(bad) + "' is not an address"));
  }
}

}  // namespace
}  // namespace kinship::app::metrics_listener_test
