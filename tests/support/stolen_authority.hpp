#pragma once

#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "proto/security/bio.hpp"
#include "proto/security/credentials.hpp"
#include "proto/security/private_files.hpp"

namespace kinship::test {

/// What somebody makes who has come by the key of an authority, and has kept what was ever sent in
/// clear.
class StolenAuthority {
 public:
  /// \param key          file of the key.
  /// \param credentials  folder of credentials that it issued.
  /// \param everything   folder below which all documents lie that were ever sent.
  StolenAuthority(const std::filesystem::path& key, const std::filesystem::path& credentials,
                  const std::filesystem::path& everything)
      : authority_{
            security::key_from_pem(security::read_file(key), key.string()),
            std::move(certificates(security::CredentialFiles(credentials).authorities).at(0))} {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(everything))
      if (entry.path().extension() == ".p7s")
        keep_certificates(security::read_file(entry.path()));
  }

  /// A document signed with the key, together with every certificate that was ever shown.
  std::string sign(const std::string& text, const security::Validity& validity) const {
    return security::sign_document(text, authority_, validity);
  }

  /// Gives the credentials in `folder` another identity.
  void replace_identity(const std::filesystem::path& folder, const std::string& name,
                        const security::Validity& validity) const {
    const security::Key key = security::make_key();
    const security::Certificate certificate =
        security::issue({.name = name, .use = security::Use::Identity, .validity = validity}, *key,
                        *authority_.certificate, *authority_.key);
    const security::CredentialFiles files(folder);
    security::replace_file(files.key, security::to_pem(*key), security::Readers::Owner);
    security::replace_file(files.certificate, security::to_pem(*certificate),
                           security::Readers::Everybody);
  }

  const security::Certificate& certificate() const { return authority_.certificate; }
  std::size_t seen() const { return authority_.crossed.size(); }

 private:
  static std::vector<security::Certificate> certificates(const std::filesystem::path& file) {
    return security::certificates_from_pem(security::read_file(file), file.string());
  }

  void keep_certificates(const std::string& document) {
    const security::Bio input = security::bio_of(document);
    BIO* content = nullptr;
    const std::unique_ptr<PKCS7, decltype(&PKCS7_free)> read(
        SMIME_read_PKCS7(input.get(), &content), &PKCS7_free);
    const security::Bio content_owner(content);
    const STACK_OF(X509)* const shown = read ? read->d.sign->cert : nullptr;
    for (int i = 0; i < sk_X509_num(shown); ++i) {
      X509* const one = sk_X509_value(shown, i);
      X509_up_ref(one);
      authority_.crossed.emplace_back(one);
    }
  }

  security::Authority authority_;
};

}  // namespace kinship::test
