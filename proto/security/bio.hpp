#pragma once

#include <openssl/bio.h>

#include <memory>
#include <string>
#include <string_view>

#include "proto/security/handles.hpp"

/// OpenSSL's streams over memory. For sources of proto/security only.
namespace kinship::security {

struct DeleteBio {
  void operator()(BIO* bio) const noexcept { BIO_free_all(bio); }
};
using Bio = std::unique_ptr<BIO, DeleteBio>;

/// An empty stream to write into.
inline Bio memory_bio() {
  Bio bio(BIO_new(BIO_s_mem()));
  if (!bio)
    throw_openssl("memory");
  return bio;
}

/// A stream that reads `text`, which has to outlive it.
inline Bio bio_of(std::string_view text) {
  Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  if (!bio)
    throw_openssl("memory");
  return bio;
}

/// The text written into a stream and not yet read.
inline std::string text_of(BIO& bio) {
  std::string text(BIO_ctrl_pending(&bio), '\0');
  const int size = text.empty() ? 0 : BIO_read(&bio, text.data(), static_cast<int>(text.size()));
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return text;
}

}  // namespace kinship::security
