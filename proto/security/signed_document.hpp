#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/security/certificate.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// Who signs: the key and certificate of an authority.
struct Authority {
  Key key;
  Certificate certificate;
  /// Certificates of this authority's key by others: who trusts one of these only can verify what
  /// this one signs.
  std::vector<Certificate> crossed = {};
};

/// A document as DDS Security wants it: S/MIME, multipart/signed, the text in clear.
///
/// It is signed with a key that is made for it and forgotten then, whose certificate the authority
/// issues: so who trusts another authority can be shown a way to it, too.
std::string sign_document(std::string_view text, const Authority& authority,
                          const Validity& validity);

/// The text of a signed document, if `trusted` vouches for it now: exactly what Cyclone DDS's
/// plugin for access control does.
Result<std::string> verify_document(std::string_view document, x509_st& trusted);

}  // namespace kinship::security
