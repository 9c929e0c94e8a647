#include "server/http/message.hpp"

#include <gtest/gtest.h>

namespace kinship::http::message_test {
namespace {

TEST(Target, HasPartsAndAQueryDecoded) {
  const Request request = with_target({}, "/robots/a%2Fb%20c?x=1&name=bin+pick%26&empty").value();
  EXPECT_EQ(request.path, "/robots/a%2Fb%20c");
  EXPECT_EQ(request.parts, (std::vector<std::string>{"robots", "a/b c"}));
  EXPECT_EQ(request.query_value("x"), "1");
  EXPECT_EQ(request.query_value("name"), "bin pick&");
  EXPECT_EQ(request.query_value("empty"), "");
  EXPECT_EQ(request.query_value("missing"), "");
  EXPECT_TRUE(with_target({}, "/").value().parts.empty());
}

TEST(Target, IsRefusedWhereItIsNoPath) {
  for (const char* const wrong : {"", "*", "http://evil.example/", "/%", "/%4", "/%zz", "/?%g1=2"})
    EXPECT_FALSE(with_target({}, wrong)) << wrong;
}

TEST(Cookies, AreFoundByTheirWholeName) {
  const Request request{.fields = {{"cookie", "a=1; session-b=2;session=3; d"}}};
  EXPECT_EQ(cookie_of(request, "a"), "1");
  EXPECT_EQ(cookie_of(request, "session"), "3");
  EXPECT_EQ(cookie_of(request, "d"), "");
  EXPECT_EQ(cookie_of(request, "b"), "");
  EXPECT_EQ(cookie_of({}, "a"), "");
}

}  // namespace
}  // namespace kinship::http::message_test
