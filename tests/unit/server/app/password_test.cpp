#include "server/app/password.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace kinship::app::password_test {
namespace {

using Cases = std::vector<std::pair<std::string, std::string>>;

TEST(Password, IsLeftOutOfUrlsWhereverItStands) {
  const Cases cases = {
      {"postgresql://ann:s3cret@db1:5432,db2/fleet?sslmode=require",
       "postgresql://ann@db1:5432,db2/fleet?sslmode=require"},
      {"postgres://ann:s3cret@db1/fleet", "postgres://ann@db1/fleet"},
      {"postgresql://ann:s3cr@et@db1/fleet", "postgresql://ann@db1/fleet"},
      {"postgresql://ann:s3c?ret@db1/fleet", "postgresql://ann@db1/fleet"},
      {"postgresql://ann:s3c/ret@db1/fleet", "postgresql://ann@db1/fleet"},
      {"postgresql://ann:s3:cret@db1", "postgresql://ann@db1"},
      {"postgresql://:s3cret@/fleet", "postgresql://@/fleet"},
      {"postgresql://db1/fleet?password=s3cret", "postgresql://db1/fleet"},
      {"postgresql://db1/fleet?user=ann&password=s3cret&sslmode=require",
       "postgresql://db1/fleet?user=ann&sslmode=require"},
      {"postgresql:///fleet?p%61ssword=s3cret&host=/tmp&sslpassword=s3cret&PASSWORD=s3cret",
       "postgresql:///fleet?host=/tmp"}};
  for (const auto& [url, shown] : cases) {
    EXPECT_EQ(without_password(url), shown);
    EXPECT_EQ(without_password(shown), shown);
  }
}

TEST(Password, WhatHasNoneStaysAsItIs) {
  for (const char* const text :
       {"", "/var/lib/kinship/fleet.db", "a:b@c.db", "postgresql://ann@db1:5432,db2:5433/fleet",
        "postgresql://db1:5432/fleet?user=ann@site&passfile=/etc/kinship/pgpass&sslmode=require",
        "postgresql:///fleet", "postgresql://"})
    EXPECT_EQ(without_password(text), text);
}

TEST(Password, IsInNothingThatIsSaidOfACommandLine) {
  const std::vector<const char*> arguments = {"kinshipd", "postgresql://ann:s3cret@db1/fleet",
                                              "--store", "a.db"};
  EXPECT_EQ(without_passwords_of(arguments,
                                 "not expected: postgresql://ann:s3cret@db1/fleet\n"
                                 "not expected: postgresql://ann:s3cret@db1/fleet, a.db"),
            "not expected: postgresql://ann@db1/fleet\n"
            "not expected: postgresql://ann@db1/fleet, a.db");
}

}  // namespace
}  // namespace kinship::app::password_test
