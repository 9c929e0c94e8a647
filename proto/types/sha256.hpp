#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "proto/types/digest.hpp"

struct evp_md_ctx_st;

namespace kinship {

/// Collects typed values into a SHA-256 digest. Every value is written with a fixed width in
/// little-endian order, text with its length, so that no two sequences of values collide.
/// Not shared between threads.
class Sha256 {
 public:
  Sha256();

  Sha256& add(std::span<const std::uint8_t> bytes);  ///< raw bytes, without a length
  Sha256& add(std::string_view text);                ///< 8-byte length, then the bytes
  Sha256& add(std::uint64_t value);
  Sha256& add(double value);                                     ///< IEEE bits; -0 counts as 0
  Sha256& add(const Eigen::Ref<const Eigen::MatrixXd>& values);  ///< rows, cols, column-major
  Sha256& add(const Digest& digest) { return add(std::span<const std::uint8_t>(digest.bytes)); }

  /// The digest of all added values. Call once.
  Digest finish();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const noexcept;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// HMAC (RFC 2104) of a message with SHA-256.
Digest hmac_sha256(const Digest& key, std::span<const std::uint8_t> message);

}  // namespace kinship
