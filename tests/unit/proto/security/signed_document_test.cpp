#include "proto/security/signed_document.hpp"

#include <gtest/gtest.h>
#include <openssl/pkcs7.h>

#include <string>

#include "proto/security/bio.hpp"
#include "proto/security/certificate.hpp"

namespace kinship::security {
namespace {

using std::chrono::days;
using std::chrono::sys_seconds;

const std::string kText = "<dds>\n  <permissions/>\n</dds>\n";
/// As S/MIME ends its lines.
const std::string kSignedText = "<dds>\r\n  <permissions/>\r\n</dds>\r\n";

sys_seconds now() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

Authority make(const std::string& name) {
  Key key = make_key();
  Certificate certificate = make_authority(
      {.name = name, .use = Use::Authority, .validity = valid_for(days(10), now())}, *key);
  return {std::move(key), std::move(certificate)};
}

TEST(SignedDocument, IsVerifiedByTheAuthorityThatSignedIt) {
  const Authority authority = make("one");
  const std::string document = sign_document(kText, authority, valid_for(days(1), now()));
  const auto text = verify_document(document, *authority.certificate);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, kSignedText);
  EXPECT_EQ(document.find("PRIVATE"), std::string::npos);
}

TEST(SignedDocument, IsRefusedByAnotherAuthorityOfTheSameName) {
  const std::string document = sign_document(kText, make("one"), valid_for(days(1), now()));
  EXPECT_FALSE(verify_document(document, *make("one").certificate));
}

TEST(SignedDocument, IsRefusedWithAnotherText) {
  const Authority authority = make("one");
  std::string document = sign_document(kText, authority, valid_for(days(1), now()));
  const std::size_t at = document.find("permissions");
  ASSERT_NE(at, std::string::npos);
  document[at] = 'P';
  EXPECT_FALSE(verify_document(document, *authority.certificate));
}

TEST(SignedDocument, IsRefusedOnceItsTimeIsOver) {
  const Authority authority = make("one");
  const Validity past{now() - days(3), now() - days(1)};
  EXPECT_FALSE(verify_document(sign_document(kText, authority, past), *authority.certificate));
}

TEST(SignedDocument, WhatAClientSignsItselfIsRefused) {
  const Authority authority = make("one");
  const Key key = make_key();
  const Certificate certificate =
      issue({.name = "r1", .use = Use::Identity, .validity = valid_for(days(1), now())}, *key,
            *authority.certificate, *authority.key);
  constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT | PKCS7_STREAM;
  const Bio input = bio_of(kText);
  const std::unique_ptr<PKCS7, decltype(&PKCS7_free)> document(
      PKCS7_sign(certificate.get(), key.get(), nullptr, input.get(), kFlags), &PKCS7_free);
  ASSERT_TRUE(document);
  const Bio output = memory_bio();
  ASSERT_EQ(SMIME_write_PKCS7(output.get(), document.get(), input.get(), kFlags), 1);

  const auto text = verify_document(text_of(*output), *authority.certificate);

  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("certificate verify error"), std::string::npos)
      << text.error().message;
}

TEST(SignedDocument, OfANewAuthorityIsVerifiedByWhoTrustsTheOneThatCrossedIt) {
  const Authority old_one = make("old");
  Authority new_one = make("new");
  const auto signed_by_new = [&] {
    return sign_document(kText, new_one, valid_for(days(1), now()));
  };
  EXPECT_FALSE(verify_document(signed_by_new(), *old_one.certificate));

  new_one.crossed.push_back(
      issue({.name = "new", .use = Use::CrossedAuthority, .validity = valid_for(days(1), now())},
            *new_one.key, *old_one.certificate, *old_one.key));

  const auto by_old = verify_document(signed_by_new(), *old_one.certificate);
  const auto by_new = verify_document(signed_by_new(), *new_one.certificate);
  EXPECT_TRUE(by_old) << by_old.error().message;
  EXPECT_TRUE(by_new) << by_new.error().message;
}

TEST(SignedDocument, WhatIsNoneIsAnErrorNotAnEnd) {
  const Authority authority = make("one");
  for (const std::string document : {"", "MIME-Version: 1.0\n", "no document"})
    EXPECT_FALSE(verify_document(document, *authority.certificate)) << document;
}

}  // namespace
}  // namespace kinship::security
