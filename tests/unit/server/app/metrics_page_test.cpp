#include "server/app/metrics_page.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace kinship::app::metrics_page_test {
namespace {

using std::chrono::milliseconds;

http::Reply ask(const http::Handler& handler, const std::string& path, std::string method = "GET") {
  std::optional<http::Reply> reply;
  handler({.method = std::move(method), .path = path},
          [&](http::Reply answer) { reply = std::move(answer); });
  return reply.value();
}

http::Handler counting_handler(milliseconds page_age) {
  return metrics_handler([pages = 0]() mutable { return "pages " + std::to_string(++pages); },
                         page_age);
}

TEST(MetricsHandler, AnswersWithThePageOfNow) {
  const http::Handler handler = counting_handler(milliseconds(0));
  const http::Reply reply = ask(handler, "/metrics");
  EXPECT_EQ(reply.status, 200U);
  EXPECT_EQ(reply.type, "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_EQ(reply.body, "pages 1");
  EXPECT_EQ(ask(handler, "/metrics").body, "pages 2");
}

TEST(MetricsHandler, RefusesWhatIsNotThere) {
  const http::Handler handler = counting_handler(milliseconds(0));
  EXPECT_EQ(ask(handler, "/").status, 404U);
  EXPECT_EQ(ask(handler, "/metrics/..").status, 404U);
  const http::Reply reply = ask(handler, "/metrics", "DELETE");
  EXPECT_EQ(reply.status, 405U);
  EXPECT_EQ(reply.fields.front().second, "GET, HEAD");
  EXPECT_EQ(ask(handler, "/metrics", "HEAD").body, "pages 1") << "made for what was refused";
}

TEST(MetricsHandler, MakesOnePageForAllThatAskAtOnce) {
  const http::Handler handler = counting_handler(std::chrono::seconds(60));
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(ask(handler, "/metrics").body, "pages 1");
}

}  // namespace
}  // namespace kinship::app::metrics_page_test
