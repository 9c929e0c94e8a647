#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "proto/security/certificate.hpp"
#include "proto/security/private_files.hpp"
#include "proto/security/security_folder.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security::host_certificate_test {
namespace {

const std::vector<std::string> kHosts = {"localhost", "127.0.0.1", "::1", "cell-3.example"};

class HostCertificateTest : public testing::Test {
 protected:
  std::string text(const std::vector<std::string>& hosts = kHosts, std::chrono::days later = {}) {
    return read_file(folder_.host_certificate(hosts, now_ + later).certificate);
  }
  static Certificate of(const std::string& pem) {
    return std::move(certificates_from_pem(pem, "it").front());
  }

  const std::chrono::sys_seconds now_ =
      std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  test::TemporaryDirectory scratch_;
  const std::filesystem::path place_ = scratch_ / "security";
  SecurityFolder folder_ = SecurityFolder::init(place_, kDefaultDays, now_);
};

TEST_F(HostCertificateTest, NamesItsHostsAndNoOther) {
  const Certificate certificate = of(text());
  for (const std::string& host : kHosts)
    EXPECT_TRUE(names_host(*certificate, host)) << host;
  for (const char* const host : {"cell-3", "example", "127.0.0.2", "Kinship console", "server"})
    EXPECT_FALSE(names_host(*certificate, host)) << host;
  const auto authorities = certificates_from_pem(read_file(place_ / "server/ca.pem"), "ca");
  EXPECT_FALSE(check_issued(*certificate, authorities, now_));
}

TEST_F(HostCertificateTest, StaysUntilItDoesNotServeAnyMore) {
  const std::string first = text();
  EXPECT_EQ(text(), first);
  EXPECT_EQ(text({"localhost"}), first) << "it names more";
  EXPECT_EQ(text(kHosts, kDefaultDays - kWarnedBefore - std::chrono::days(1)), first);
  const std::string renewed = text(kHosts, kDefaultDays - kWarnedBefore + std::chrono::days(1));
  EXPECT_NE(renewed, first);
  EXPECT_NE(text({"other.example"}), renewed);
  std::filesystem::remove(place_ / "console/key.pem");
  EXPECT_TRUE(names_host(*of(text()), "localhost"));
  struct stat status {};
  ASSERT_EQ(stat((place_ / "console/key.pem").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0600U);
}

TEST_F(HostCertificateTest, IsOfATrustedAuthority) {
  const std::string first = text();
  folder_.replace_authority(kDefaultDays, now_);
  const std::string second = text();
  EXPECT_NE(second, first);
  const auto authorities = certificates_from_pem(read_file(place_ / "server/ca.pem"), "ca");
  EXPECT_FALSE(check_issued(*of(second), authorities, now_));
  EXPECT_TRUE(check_issued(*of(first), authorities, now_));
}

TEST_F(HostCertificateTest, NeedsTheAuthoritysKeyOnlyToBeMade) {
  const std::string first = text();
  std::filesystem::remove(place_ / "authority/ca.key");
  EXPECT_EQ(text(), first);
  EXPECT_THROW(text({"other.example"}), Failure);
}

TEST_F(HostCertificateTest, RefusesWhatIsNoHost) {
  for (const char* const host : {"", "a b", "a,DNS:evil.example", "a:80", "*"}) {
    EXPECT_FALSE(is_host(host));
    EXPECT_THROW(text({host}), Failure) << host;
  }
}

}  // namespace
}  // namespace kinship::security::host_certificate_test
