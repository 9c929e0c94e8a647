// What the key of an authority is good for that was retired, in the hands of somebody who has kept
// every document that was ever sent; and which clients still listen to it.

#include <gtest/gtest.h>

#include <string>

#include "proto/security/permissions.hpp"
#include "proto/security/private_files.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/stolen_authority.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security {
namespace {

class RetiredAuthority : public testing::Test {
 protected:
  static std::chrono::sys_seconds now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  }
  std::filesystem::path out(const std::string& name) const { return scratch_ / name.c_str(); }
  void renew(const std::string& name, const std::string& to) {
    folder_.renew(name, kDefaultDays, out(to), now());
  }

  /// The state of a client in the list.
  CredentialList::Row row(const std::string& name) const {
    for (const CredentialList::Row& row : folder_.list(now()).credentials)
      if (row.name == name)
        return row;
    return {};
  }

  /// Why a server or client with `credentials` refuses a document that `thief` signs.
  static std::string refusal(const std::filesystem::path& credentials,
                             const test::StolenAuthority& thief) {
    const auto trusted =
        certificates_from_pem(read_file(CredentialFiles(credentials).authorities), "ca.pem");
    const Validity validity = valid_for(kDefaultDays, now());
    const auto text = verify_document(
        thief.sign(client_permissions("arm", AccessRole::Admin, validity), validity),
        *trusted.at(0));
    return text ? std::string() : text.error().message;
  }

  /// Why they refuse an identity that `thief` issues.
  std::string identity_refusal(const std::filesystem::path& credentials,
                               const test::StolenAuthority& thief) const {
    const std::filesystem::path forged = out("forged");
    std::filesystem::create_directory(forged);
    thief.replace_identity(forged, "server", valid_for(kDefaultDays, now()));
    const auto certificate =
        certificates_from_pem(read_file(CredentialFiles(forged).certificate), "certificate.pem");
    const auto trusted =
        certificates_from_pem(read_file(CredentialFiles(credentials).authorities), "ca.pem");
    const auto error = check_issued(*certificate.at(0), trusted, now());
    return error ? error->message : std::string();
  }

  test::TemporaryDirectory scratch_;
  SecurityFolder folder_ = SecurityFolder::init(out("security"), kDefaultDays, now());
};

TEST_F(RetiredAuthority, ItsKeySignsNothingThatTheServerAccepts) {
  folder_.add({.name = "arm"}, out("arm"), now());
  folder_.renew_authority(kDefaultDays, now());
  renew("arm", "arm-renewed");
  folder_.renew_server(kDefaultDays, now());  // all that may be shown while there are two
  const test::StolenAuthority before(out("security/authority/previous.key"), out("arm"),
                                     scratch_.path());
  EXPECT_EQ(refusal(folder_.server_credentials(), before), "") << "still an authority";

  const std::filesystem::path key = folder_.retire_authority(kDefaultDays, now());

  const test::StolenAuthority thief(key, out("arm"), scratch_.path());
  EXPECT_GT(thief.seen(), 8U);
  EXPECT_NE(refusal(folder_.server_credentials(), thief), "");
  EXPECT_NE(identity_refusal(folder_.server_credentials(), thief), "");
  // Permissions are refused by clients, too: with a document of their authority, that is.
  EXPECT_NE(refusal(out("arm-renewed"), thief), "");
}

TEST_F(RetiredAuthority, AClientTakesItForTheServerUntilItIsRenewedOnceMoreAndTheListSaysSo) {
  folder_.add({.name = "arm"}, out("arm"), now());
  folder_.renew_authority(kDefaultDays, now());
  renew("arm", "arm-renewed");
  EXPECT_FALSE(row("arm").trusts_a_retired_authority);
  EXPECT_EQ(row("arm").trusted.size(), 2U);
  const std::filesystem::path key = folder_.retire_authority(kDefaultDays, now());
  const test::StolenAuthority thief(key, out("arm"), scratch_.path());

  EXPECT_EQ(identity_refusal(out("arm-renewed"), thief), "");
  EXPECT_TRUE(row("arm").trusts_a_retired_authority);
  EXPECT_EQ(folder_.clients_that_trust_retired(now()), std::vector<std::string>{"arm"});
  EXPECT_FALSE(row("server").trusts_a_retired_authority);

  renew("arm", "arm-again");

  EXPECT_NE(identity_refusal(out("arm-again"), thief), "");
  EXPECT_FALSE(row("arm").trusts_a_retired_authority);
  EXPECT_TRUE(folder_.clients_that_trust_retired(now()).empty());
}

TEST_F(RetiredAuthority, IsTrustedByNobodyWhoIsRenewedAfterItsKeyLeaked) {
  folder_.add({.name = "arm"}, out("arm"), now());
  const auto before = folder_.list(now()).authorities.at(0).fingerprint;

  folder_.replace_authority(kDefaultDays, now());

  EXPECT_EQ(folder_.clients_of_previous_authority(now()), std::vector<std::string>{"arm"});
  renew("arm", "arm-renewed");
  const test::StolenAuthority thief(out("security/authority/retired-" + before + ".key"),
                                    out("arm"), scratch_.path());
  for (const auto& who : {folder_.server_credentials(), out("arm-renewed")}) {
    EXPECT_NE(refusal(who, thief), "") << who;
    EXPECT_NE(identity_refusal(who, thief), "") << who;
    EXPECT_TRUE(read_credentials(who, now())) << who;
  }
  EXPECT_TRUE(folder_.clients_of_previous_authority(now()).empty());
}

TEST_F(RetiredAuthority, NeedNotHaveLeftItsKeyToBeReplaced) {
  std::filesystem::remove(out("security/authority/ca.key"));
  folder_.replace_authority(kDefaultDays, now());
  folder_.add({.name = "arm"}, out("arm"), now());
  EXPECT_TRUE(read_credentials(out("arm"), now()));
  EXPECT_EQ(folder_.list(now()).authorities.size(), 1U);
}

TEST_F(RetiredAuthority, IsNotRetiredWithoutTheKeyOfTheOneThatStays) {
  folder_.renew_authority(kDefaultDays, now());
  std::filesystem::rename(out("security/authority/ca.key"), out("elsewhere.key"));
  EXPECT_THROW(folder_.retire_authority(kDefaultDays, now()), Failure);
  EXPECT_EQ(folder_.list(now()).authorities.size(), 2U);
  SecurityFolder(out("security"), out("elsewhere.key")).retire_authority(kDefaultDays, now());
  EXPECT_EQ(folder_.list(now()).authorities.size(), 1U);
}

}  // namespace
}  // namespace kinship::security
