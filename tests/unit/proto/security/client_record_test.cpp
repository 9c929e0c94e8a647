#include "proto/security/client_record.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "proto/security/access_role.hpp"
#include "proto/security/certificate_name.hpp"

namespace kinship::security::client_record_test {
namespace {

using std::chrono::sys_days;
using namespace std::chrono_literals;

ClientRecord sample() {
  return {.name = "arm_7",
          .role = AccessRole::Operator,
          .tasks = {"shelf_*", "bin?"},
          .robots = {"ur5e", "panda.left"},
          .serial = "7f00ab",
          .generation = 3,
          .oldest_accepted = 2,
          .authority = "0123456789abcdef",
          .trusted = {"0123456789abcdef", "fedcba9876543210"},
          .expires = sys_days(2027y / 11 / 25) + 3h,
          .revoked = sys_days(2026y / 12 / 1)};
}

TEST(ClientRecord, IsReadAsItWasWritten) {
  const auto read = read_record(record_text(sample()), "arm_7.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->name, "arm_7");
  EXPECT_EQ(read->role, AccessRole::Operator);
  EXPECT_EQ(read->tasks, sample().tasks);
  EXPECT_EQ(read->robots, sample().robots);
  EXPECT_EQ(read->serial, "7f00ab");
  EXPECT_EQ(read->generation, 3U);
  EXPECT_EQ(read->oldest_accepted, 2U);
  EXPECT_EQ(read->authority, "0123456789abcdef");
  EXPECT_EQ(read->trusted, sample().trusted);
  EXPECT_EQ(read->expires, sample().expires);
  EXPECT_EQ(read->revoked, sample().revoked);
}

TEST(ClientRecord, WithoutRevocationIsNotRevoked) {
  ClientRecord record = sample();
  record.revoked.reset();
  const auto read = read_record(record_text(record), "arm_7.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->revoked);
}

/// The record with one line of it changed.
std::string with(const std::string& line, const std::string& other) {
  std::string text = record_text(sample());
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), other);
}

TEST(ClientRecord, AFieldThatNarrowsIsNeverLostInSilence) {
  for (const std::string& text :
       {with("tasks = [\"shelf_*\", \"bin?\"]\n", ""), with("robots", "robot"),
        with("[\"shelf_*\", \"bin?\"]", "\"shelf_*\""), with("\"bin?\"", "7"),
        with("oldest_accepted = 2\n", ""), with("oldest_accepted = 2", "oldest_accepted = 0"),
        with("generation = 3", "generation = 4294967296"), with("\"bin?\"", "\"\""),
        with("expires", "expired"), with("role = \"operator\"", ""),
        with("\"operator\"", "\"root\""), with("revoked = 2026-12-01T00:00:00Z", "revoked = true"),
        with("\"arm_7\"", "\"../arm\""), std::string("name ="), std::string()})
    EXPECT_FALSE(read_record(text, "arm_7.toml")) << text;
}

TEST(ClientRecord, AMessageNamesFileFieldAndValue) {
  const auto read = read_record(with("\"operator\"", "\"oprator\""), "clients/arm_7.toml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message,
            "clients/arm_7.toml: field 'role': role 'oprator' is not one of robot, reader, "
            "operator, admin (did you mean 'operator'?)");
}

TEST(ClientRecord, NamesMakeFileNamesAndPartitions) {
  const std::vector<std::string> good = {"a", "arm_7", "A-9", "-", std::string(56, 'x')};
  for (const std::string& name : good)
    EXPECT_FALSE(check_client_name(name)) << name;
  const std::vector<std::string> bad = {"",   "a b", "a/b",       "..",     "a*",
                                        "a?", "ä",   "client[1]", "server", std::string(57, 'x')};
  for (const std::string& name : bad)
    EXPECT_TRUE(check_client_name(name)) << name;
}

TEST(ClientRecord, RolesHaveTheNamesOfTheirValues) {
  EXPECT_EQ(role_name(AccessRole::Robot), "robot");
  EXPECT_EQ(role_name(AccessRole::Reader), "reader");
  EXPECT_EQ(role_name(AccessRole::Operator), "operator");
  EXPECT_EQ(role_name(AccessRole::Admin), "admin");
}

TEST(CertificateName, HasItsGenerationBehindAPointFromTheSecondOn) {
  EXPECT_EQ(common_name(CertificateName{"arm_7"}), "arm_7");
  EXPECT_EQ(common_name(CertificateName{"arm_7", 12}), "arm_7.12");
  for (const std::string& name :
       {std::string("arm_7"), std::string("arm_7.2"), std::string("a.4294967295")}) {
    const auto read = read_certificate_name(name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(common_name(*read), name);
  }
  EXPECT_EQ(read_certificate_name("arm_7.12")->client, "arm_7");
  EXPECT_EQ(read_certificate_name("arm_7.12")->generation, 12U);
}

TEST(CertificateName, EachGenerationHasOneForm) {
  for (const char* const name :
       {"arm.", "arm.1", "arm.0", "arm.02", "arm.2 ", "arm.-2", "arm.+2", "arm.2.3", "arm.x", ".2",
        "", "arm.4294967296", "server", "server.2"})
    EXPECT_FALSE(read_certificate_name(name)) << name;
}

TEST(CertificateName, WhatIsNoClientsStaysWhatItIs) {
  EXPECT_EQ(client_of("arm_7.2"), "arm_7");
  EXPECT_EQ(client_of("server"), "server");
}

}  // namespace
}  // namespace kinship::security::client_record_test
