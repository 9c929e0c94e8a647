#include "server/console/gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kinship::console::gate_test {
namespace {

constexpr const char* kToken = "0123456789abcdef";

using Fields = std::map<std::string, std::string>;

http::Request request(const std::string& target, Fields fields = {},
                      const std::string& method = "GET") {
  http::Request request = http::with_target({}, target).value();
  request.method = method;
  request.fields = std::move(fields);
  request.fields.try_emplace("host", "localhost:9480");
  return request;
}

Fields with_cookie(Fields fields = {}) {
  fields["cookie"] = std::string("other=1; kinship-console-9480=") + kToken;
  return fields;
}

std::string value_of(const http::Reply& reply, const std::string& name) {
  for (const auto& [each, value] : reply.fields)
    if (each == name)
      return value;
  return {};
}

class GateTest : public testing::Test {
 protected:
  unsigned status(const http::Request& asked) const {
    const std::optional<http::Reply> stopped = gate_.stop(asked);
    return stopped ? stopped->status : 0;
  }
  const Gate gate_{kToken, 9480, false};
};

TEST_F(GateTest, LetsInByTheLinkAndThenByItsCookie) {
  EXPECT_EQ(gate_.link("http://localhost:9480"), "http://localhost:9480/?token=0123456789abcdef");
  const auto reply = gate_.stop(request("/tasks/a%22b?token=0123456789abcdef"));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200U);
  EXPECT_NE(reply->body.find("content=\"0;url=/tasks/a%22b\""), std::string::npos) << reply->body;
  EXPECT_EQ(value_of(*reply, "Set-Cookie"),
            "kinship-console-9480=0123456789abcdef; Path=/; HttpOnly; SameSite=Strict; "
            "Max-Age=2592000");
  EXPECT_EQ(status(request("/", with_cookie())), 0U);
}

TEST_F(GateTest, OverTlsTheCookieStaysThere) {
  const Gate gate(kToken, 9480, true);
  const auto reply = gate.stop(request("/?token=0123456789abcdef"));
  EXPECT_TRUE(value_of(reply.value(), "Set-Cookie").ends_with("; Secure"));
}

TEST_F(GateTest, StopsWhatHasAnotherTokenOrNone) {
  EXPECT_EQ(status(request("/")), 401U);
  EXPECT_EQ(status(request("/api/events")), 401U);
  for (const std::string wrong : {"", "0123456789abcde", "0123456789abcdeF", "0123456789abcdef0"}) {
    EXPECT_EQ(status(request("/?token=" + wrong)), 403U) << wrong;
    EXPECT_EQ(status(request("/", {{"cookie", "kinship-console-9480=" + wrong}})), 401U) << wrong;
  }
  EXPECT_EQ(status(request("/", {{"cookie", std::string("kinship-console-1=") + kToken}})), 401U);
}

TEST_F(GateTest, DoesNotPutAPathIntoThePageAsHtml) {
  const auto reply = gate_.stop(request("/\"><script>alert(1)</script>"));
  EXPECT_EQ(reply.value().body.find("<script>"), std::string::npos) << reply->body;
}

TEST_F(GateTest, ChangesComeFromItsOwnPagesAlone) {
  const auto post = [&](const std::string& origin) {
    return status(request("/api/rows/reset_task", with_cookie({{"origin", origin}}), "POST"));
  };
  EXPECT_EQ(post("http://localhost:9480"), 0U);
  for (const char* const other : {"http://localhost:9481", "http://evil.example", "null", "",
                                  "https://localhost:9480", "http://localhost:9480.evil.example"})
    EXPECT_EQ(post(other), 403U) << other;
  EXPECT_EQ(status(request("/api/rows/reset_task", with_cookie(), "POST")), 403U) << "no origin";
}

TEST_F(GateTest, ReadsForItsOwnPagesAndForWhoFollowsALink) {
  const auto read = [&](const std::string& site, const std::string& mode) {
    return status(
        request("/api/events", with_cookie({{"sec-fetch-site", site}, {"sec-fetch-mode", mode}})));
  };
  EXPECT_EQ(read("same-origin", "cors"), 0U);
  EXPECT_EQ(read("none", "navigate"), 0U);
  EXPECT_EQ(read("cross-site", "navigate"), 0U);
  EXPECT_EQ(read("cross-site", "cors"), 403U);
  EXPECT_EQ(read("same-site", "no-cors"), 403U) << "a page of another port of this host";
}

TEST(Guarded, RepliesLoadNothingFromElsewhere) {
  const http::Reply reply = guarded({});
  EXPECT_TRUE(value_of(reply, "Content-Security-Policy").starts_with("default-src 'self'; "));
  EXPECT_EQ(value_of(reply, "Content-Security-Policy").find("unsafe"), std::string::npos);
  EXPECT_EQ(value_of(reply, "Referrer-Policy"), "no-referrer");
  EXPECT_EQ(value_of(reply, "Cache-Control"), "no-store");
  const http::Reply kept = guarded({.fields = {{"Cache-Control", "immutable"}}});
  EXPECT_EQ(std::ranges::count_if(kept.fields,
                                  [](const auto& field) { return field.first == "Cache-Control"; }),
            1);
}

}  // namespace
}  // namespace kinship::console::gate_test
