#include "proto/security/certificate.hpp"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "proto/security/bio.hpp"

namespace kinship::security {
namespace {

constexpr std::chrono::days kClockSlack{1};

/// One extension in the words of OpenSSL's configuration.
struct Extension {
  int nid;
  std::string value;
};

bool is_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

/// "DNS:localhost,IP:127.0.0.1"
std::string alternative_names(const std::vector<std::string>& hosts) {
  std::string names;
  for (const std::string& host : hosts) {
    if (!is_host(host))
      throw Failure(ErrorCode::InvalidInput, "certificate: '" + host + "' is no host");
    names += (names.empty() ? "" : ",") + std::string(is_address(host) ? "IP:" : "DNS:") + host;
  }
  return names;
}

std::vector<Extension> extensions_of(const CertificateText& text) {
  const Extension subject{NID_subject_key_identifier, "hash"};
  const Extension issuer{NID_authority_key_identifier, "keyid"};
  switch (text.use) {
    case Use::Authority:  // an authority that is crossed stands between it and what it vouches for
      return {{NID_basic_constraints, "critical,CA:TRUE,pathlen:1"},
              {NID_key_usage, "critical,keyCertSign,cRLSign"},
              subject};
    case Use::CrossedAuthority:
      return {{NID_basic_constraints, "critical,CA:TRUE,pathlen:0"},
              {NID_key_usage, "critical,keyCertSign,cRLSign"},
              subject,
              issuer};
    case Use::Identity:
      return {{NID_basic_constraints, "critical,CA:FALSE"},
              {NID_key_usage, "critical,digitalSignature,keyAgreement"},
              {NID_ext_key_usage, "critical,clientAuth,serverAuth"},
              subject,
              issuer};
    case Use::Documents:
      return {{NID_basic_constraints, "critical,CA:FALSE"},
              {NID_key_usage, "critical,digitalSignature"},
              {NID_ext_key_usage, "critical,emailProtection"},
              subject,
              issuer};
    case Use::Host:
      return {{NID_basic_constraints, "critical,CA:FALSE"},
              {NID_key_usage, "critical,digitalSignature"},
              {NID_ext_key_usage, "serverAuth"},
              {NID_subject_alt_name, alternative_names(text.hosts)},
              subject,
              issuer};
  }
  return {};
}

void set_name(X509_NAME* name, const std::string& common_name) {
  const auto add = [&](const char* field, const std::string& value) {
    std::vector<unsigned char> bytes(value.begin(), value.end());
    if (X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8, bytes.data(),
                                   static_cast<int>(bytes.size()), -1, 0) != 1)
      throw_openssl("certificate of '" + common_name + "': subject");
  };
  add("O", "Kinship");
  add("CN", common_name);
}

void set_random_serial(x509_st& certificate) {
  constexpr int kBits = 127;
  const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(BN_new(), &BN_free);
  if (!number || BN_rand(number.get(), kBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) != 1 ||
      BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&certificate)) == nullptr)
    throw_openssl("certificate: serial number");
}

void set_validity(x509_st& certificate, const Validity& validity) {
  const auto set = [](ASN1_TIME* time, std::chrono::sys_seconds at) {
    if (ASN1_TIME_set(time, std::chrono::system_clock::to_time_t(at)) == nullptr)
      throw_openssl("certificate: validity");
  };
  set(X509_getm_notBefore(&certificate), validity.begin);
  set(X509_getm_notAfter(&certificate), validity.end);
}

void add_extensions(x509_st& certificate, x509_st& issuer, const CertificateText& text) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, &issuer, &certificate, nullptr, nullptr, 0);
  for (const Extension& wanted : extensions_of(text)) {
    const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> extension(
        X509V3_EXT_conf_nid(nullptr, &context, wanted.nid, wanted.value.c_str()),
        &X509_EXTENSION_free);
    if (!extension || X509_add_ext(&certificate, extension.get(), -1) != 1)
      throw_openssl("certificate: extension " + wanted.value);
  }
}

/// \param issuer  null: the certificate signs itself.
Certificate make_certificate(const CertificateText& text, evp_pkey_st& subject_key, x509_st* issuer,
                             evp_pkey_st& issuer_key) {
  constexpr long kVersion3 = 2;
  Certificate certificate(X509_new());
  if (!certificate || X509_set_version(certificate.get(), kVersion3) != 1 ||
      X509_set_pubkey(certificate.get(), &subject_key) != 1)
    throw_openssl("certificate of '" + text.name + "'");
  x509_st& signer = issuer == nullptr ? *certificate : *issuer;
  set_random_serial(*certificate);
  set_validity(*certificate, text.validity);
  set_name(X509_get_subject_name(certificate.get()), text.name);
  if (X509_set_issuer_name(certificate.get(), X509_get_subject_name(&signer)) != 1)
    throw_openssl("certificate of '" + text.name + "': issuer");
  add_extensions(*certificate, signer, text);
  if (X509_sign(certificate.get(), &issuer_key, EVP_sha256()) == 0)
    throw_openssl("certificate of '" + text.name + "': signature");
  return certificate;
}

/// \param what  of the validity, for messages.
std::chrono::sys_seconds time_of(const ASN1_TIME* time, const std::string& what) {
  std::tm fields{};
  if (ASN1_TIME_to_tm(time, &fields) != 1)
    throw_openssl("certificate: " + what + " of validity");
  return std::chrono::sys_seconds(std::chrono::seconds(timegm(&fields)));
}

}  // namespace

bool is_host(std::string_view text) {
  constexpr std::size_t kMostBytes = 253;
  const auto is_letter = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (letter >= '0' && letter <= '9') || letter == '-' || letter == '.';
  };
  return is_address(std::string(text)) ||
         (!text.empty() && text.size() <= kMostBytes && std::ranges::all_of(text, is_letter));
}

bool names_host(x509_st& certificate, const std::string& host) {
  constexpr unsigned kNotTheSubject = X509_CHECK_FLAG_NEVER_CHECK_SUBJECT;
  const bool is_named =
      is_address(host)
          ? X509_check_ip_asc(&certificate, host.c_str(), kNotTheSubject) == 1
          : X509_check_host(&certificate, host.c_str(), host.size(), kNotTheSubject, nullptr) == 1;
  ERR_clear_error();
  return is_named;
}

Validity valid_for(std::chrono::days days, std::chrono::sys_seconds now) {
  return {now - kClockSlack, now + days};
}

Key make_key() {
  Key key(EVP_EC_gen("P-256"));
  if (!key)
    throw_openssl("key");
  return key;
}

Certificate make_authority(const CertificateText& text, evp_pkey_st& key) {
  return make_certificate(text, key, nullptr, key);
}

Certificate issue(const CertificateText& text, evp_pkey_st& subject_key, x509_st& issuer,
                  evp_pkey_st& issuer_key) {
  return make_certificate(text, subject_key, &issuer, issuer_key);
}

std::string to_pem(x509_st& certificate) {
  const Bio bio = memory_bio();
  if (PEM_write_bio_X509(bio.get(), &certificate) != 1)
    throw_openssl("certificate as PEM");
  return text_of(*bio);
}

std::string to_pem(evp_pkey_st& key) {
  const Bio bio(BIO_new(BIO_s_secmem()));
  if (!bio || PEM_write_bio_PrivateKey(bio.get(), &key, nullptr, nullptr, 0, nullptr, nullptr) != 1)
    throw_openssl("key as PEM");
  return text_of(*bio);
}

std::vector<Certificate> certificates_from_pem(std::string_view pem, std::string_view what) {
  const Bio bio = bio_of(pem);
  std::vector<Certificate> certificates;
  while (Certificate next{PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr)})
    certificates.push_back(std::move(next));
  const unsigned long error = ERR_peek_last_error();
  ERR_clear_error();
  if (ERR_GET_REASON(error) != PEM_R_NO_START_LINE)
    throw Failure(ErrorCode::InvalidInput,
                  std::string(what) + ": certificate " + std::to_string(certificates.size() + 1) +
                      " cannot be read: " + ERR_reason_error_string(error));
  return certificates;
}

Key key_from_pem(std::string_view pem, std::string_view what) {
  const Bio bio = bio_of(pem);
  // No password is asked for: an empty one is offered.
  const auto no_password = [](char*, int, int, void*) { return 0; };
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
  ERR_clear_error();
  if (!key)
    throw Failure(ErrorCode::InvalidInput,
                  std::string(what) + ": has no private key in PEM without a password");
  return key;
}

std::string common_name(x509_st& certificate) {
  X509_NAME* const subject = X509_get_subject_name(&certificate);
  const int at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (at < 0)
    return {};
  const ASN1_STRING* const value = X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at));
  const unsigned char* const bytes = ASN1_STRING_get0_data(value);
  return {bytes, bytes + ASN1_STRING_length(value)};
}

std::string serial_text(x509_st& certificate) {
  const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(
      ASN1_INTEGER_to_BN(X509_get_serialNumber(&certificate), nullptr), &BN_free);
  const Bio bio = memory_bio();
  if (!number || BN_print(bio.get(), number.get()) != 1)
    throw_openssl("certificate: serial number");
  std::string text = text_of(*bio);
  for (char& digit : text)
    if (digit >= 'A' && digit <= 'F')
      digit = static_cast<char>(digit - 'A' + 'a');
  return text;
}

std::string fingerprint(x509_st& certificate) {
  constexpr std::size_t kBytes = 8;
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (X509_digest(&certificate, EVP_sha256(), digest.data(), &size) != 1)
    throw_openssl("certificate: fingerprint");
  std::string text;
  for (std::size_t i = 0; i < kBytes; ++i) {
    text += kDigits[digest.at(i) >> 4U];
    text += kDigits[digest.at(i) & 0xFU];
  }
  return text;
}

std::chrono::sys_seconds beginning(x509_st& certificate) {
  return time_of(X509_get0_notBefore(&certificate), "beginning");
}

std::chrono::sys_seconds expiry(x509_st& certificate) {
  return time_of(X509_get0_notAfter(&certificate), "end");
}

bool belongs_to(evp_pkey_st& key, x509_st& certificate) {
  const bool belongs = X509_check_private_key(&certificate, &key) == 1;
  ERR_clear_error();
  return belongs;
}

std::optional<Error> check_issued(x509_st& certificate, const std::vector<Certificate>& authorities,
                                  std::chrono::sys_seconds now) {
  const std::unique_ptr<X509_STORE, decltype(&X509_STORE_free)> store(X509_STORE_new(),
                                                                      &X509_STORE_free);
  const std::unique_ptr<X509_STORE_CTX, decltype(&X509_STORE_CTX_free)> context(
      X509_STORE_CTX_new(), &X509_STORE_CTX_free);
  if (!store || !context)
    throw_openssl("verification");
  for (const Certificate& authority : authorities)
    if (X509_STORE_add_cert(store.get(), authority.get()) != 1)
      throw_openssl("verification: authority");
  if (X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr) != 1)
    throw_openssl("verification");
  X509_STORE_CTX_set_time(context.get(), 0, std::chrono::system_clock::to_time_t(now));
  const bool is_issued = X509_verify_cert(context.get()) == 1;
  ERR_clear_error();
  if (is_issued)
    return std::nullopt;
  return invalid_input("certificate of '" + common_name(certificate) + "': " +
                       X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get())));
}

}  // namespace kinship::security
