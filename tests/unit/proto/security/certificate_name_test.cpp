#include "proto/security/certificate_name.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::security {
namespace {

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
}  // namespace kinship::security
