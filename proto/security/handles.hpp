#pragma once

#include <memory>
#include <string_view>

struct evp_pkey_st;
struct x509_st;

namespace kinship::security {

struct DeleteKey {
  void operator()(evp_pkey_st* key) const noexcept;
};
struct DeleteCertificate {
  void operator()(x509_st* certificate) const noexcept;
};

/// Owner of one OpenSSL key, private and public part, or public part only.
using Key = std::unique_ptr<evp_pkey_st, DeleteKey>;
/// Owner of one OpenSSL certificate.
using Certificate = std::unique_ptr<x509_st, DeleteCertificate>;

/// \throws Failure(Internal) with `what` and the oldest reason in OpenSSL's queue of this thread,
///         and empties the queue.
[[noreturn]] void throw_openssl(std::string_view what);

}  // namespace kinship::security
