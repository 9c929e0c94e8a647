#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/security/handles.hpp"
#include "proto/types/failure.hpp"

namespace kinship::security {

/// A period of validity, UTC.
struct Validity {
  std::chrono::sys_seconds begin = {};
  std::chrono::sys_seconds end = {};
};

/// `days` from now on; begins a day earlier, for robots whose clocks are behind.
Validity valid_for(std::chrono::days days, std::chrono::sys_seconds now);

/// Use of a certificate.
enum class Use {
  Authority,         ///< issues certificates
  CrossedAuthority,  ///< for the key of another authority, which issues certificates
  Identity,          ///< of a participant: signs no documents
  Documents,         ///< signs governance and permissions: of no participant
  Host               ///< of a web server, which browsers know by its names: of no participant
};

/// Content of a new certificate.
struct CertificateText {
  std::string name;  ///< common name; the organization is Kinship
  Use use = Use::Identity;
  Validity validity;
  std::vector<std::string> hosts = {};  ///< of Use::Host: names and addresses, see is_host()
};

/// Whether a text is a host's name (letters, digits, - and dots, 253 bytes at most) or an address.
bool is_host(std::string_view text);

/// Whether a certificate is for a host, by its subjectAltName.
bool names_host(x509_st& certificate, const std::string& host);

/// A new key: EC P-256.
Key make_key();

/// A certificate that an authority signs with its own key.
Certificate make_authority(const CertificateText& text, evp_pkey_st& key);

/// A certificate for `subject_key`, signed with the key of `issuer`.
/// \throws Failure(InvalidInput) for hosts that are none.
Certificate issue(const CertificateText& text, evp_pkey_st& subject_key, x509_st& issuer,
                  evp_pkey_st& issuer_key);

std::string to_pem(x509_st& certificate);
std::string to_pem(evp_pkey_st& key);  ///< PKCS#8, not encrypted

/// All certificates of a PEM text, in order; none if it has none.
/// \param what  names the text in messages.
/// \throws Failure(InvalidInput) for an unreadable one.
std::vector<Certificate> certificates_from_pem(std::string_view pem, std::string_view what);

/// \throws Failure(InvalidInput) if it has no private key.
Key key_from_pem(std::string_view pem, std::string_view what);

std::string common_name(x509_st& certificate);  ///< of its subject; empty if there is none
std::string serial_text(x509_st& certificate);  ///< hexadecimal, lower case
std::string fingerprint(x509_st& certificate);  ///< first 16 hexadecimal digits of its SHA-256
std::chrono::sys_seconds beginning(x509_st& certificate);  ///< of its validity
std::chrono::sys_seconds expiry(x509_st& certificate);

/// Whether the certificate is for this key.
bool belongs_to(evp_pkey_st& key, x509_st& certificate);

/// Why none of `authorities` vouches for the certificate at `now`; nothing if one does.
std::optional<Error> check_issued(x509_st& certificate, const std::vector<Certificate>& authorities,
                                  std::chrono::sys_seconds now);

}  // namespace kinship::security
