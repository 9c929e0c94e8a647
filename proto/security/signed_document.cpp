#include "proto/security/signed_document.hpp"

#include <openssl/err.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <array>
#include <string>

#include "proto/security/bio.hpp"

namespace kinship::security {
namespace {

struct DeleteDocument {
  void operator()(PKCS7* document) const noexcept { PKCS7_free(document); }
};
using Document = std::unique_ptr<PKCS7, DeleteDocument>;

/// Certificates that are lent to OpenSSL as one of its lists.
class CertificateList {
 public:
  explicit CertificateList(const std::vector<Certificate>& certificates)
      : list_(sk_X509_new_null()) {
    for (const Certificate& certificate : certificates)
      if (list_ == nullptr || sk_X509_push(list_, certificate.get()) == 0)
        throw_openssl("list of certificates");
  }
  CertificateList(const CertificateList&) = delete;
  CertificateList& operator=(const CertificateList&) = delete;
  ~CertificateList() { sk_X509_free(list_); }

  STACK_OF(X509) * get() const noexcept { return list_; }

 private:
  STACK_OF(X509) * list_;
};

}  // namespace

std::string sign_document(std::string_view text, const Authority& authority,
                          const Validity& validity) {
  constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT | PKCS7_STREAM | PKCS7_NOSMIMECAP;
  const Key key = make_key();
  const Certificate certificate =
      issue({.name = "documents", .use = Use::Documents, .validity = validity}, *key,
            *authority.certificate, *authority.key);
  const CertificateList crossed(authority.crossed);
  const Bio input = bio_of(text);
  const Document document(
      PKCS7_sign(certificate.get(), key.get(), crossed.get(), input.get(), kFlags));
  const Bio output = memory_bio();
  if (!document || SMIME_write_PKCS7(output.get(), document.get(), input.get(), kFlags) != 1)
    throw_openssl("signed document");
  return text_of(*output);
}

Result<std::string> verify_document(std::string_view document, x509_st& trusted) {
  const Bio input = bio_of(document);
  BIO* content = nullptr;
  const Document read(SMIME_read_PKCS7(input.get(), &content));
  const Bio content_owner(content);
  const std::unique_ptr<X509_STORE, decltype(&X509_STORE_free)> store(X509_STORE_new(),
                                                                      &X509_STORE_free);
  const Bio text = memory_bio();
  if (read && store && X509_STORE_add_cert(store.get(), &trusted) == 1 &&
      PKCS7_verify(read.get(), nullptr, store.get(), content, text.get(), PKCS7_TEXT) == 1)
    return text_of(*text);
  std::array<char, 256> reason{};
  ERR_error_string_n(ERR_peek_last_error(), reason.data(), reason.size());
  ERR_clear_error();
  return invalid_input(std::string("signed document: ") + reason.data());
}

}  // namespace kinship::security
