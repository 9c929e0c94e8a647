#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/security/certificate.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// A signing authority: its key and certificate.
struct Authority {
  Key key;
  Certificate certificate;
  /// Certificates of this authority's key by others: a participant that trusts only one of these
  /// can verify its signatures.
  std::vector<Certificate> crossed = {};
};

/// Signs a document for DDS Security: S/MIME, multipart/signed, the text in clear.
///
/// It is signed with a new key, discarded afterwards, whose certificate the authority issues: so a
/// certificate chain can lead to another trusted authority, too.
std::string sign_document(std::string_view text, const Authority& authority,
                          const Validity& validity);

/// The text of a signed document, if `trusted` vouches for it now: the same check as in Cyclone
/// DDS's plugin for access control.
Result<std::string> verify_document(std::string_view document, x509_st& trusted);

}  // namespace kinship::security
