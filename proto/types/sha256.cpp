#include "proto/types/sha256.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "proto/types/failure.hpp"

namespace kinship {
namespace {

void require(int ok) {
  if (ok != 1)
    throw Failure(ErrorCode::Internal, "libcrypto: SHA-256 failed");
}

/// Fetched once and kept: EVP_sha256() would be looked up by name for each hash, for 2 us.
const EVP_MD* algorithm() {
  static const EVP_MD* const kAlgorithm = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  return kAlgorithm;
}

}  // namespace

void Sha256::Free::operator()(evp_md_ctx_st* context) const noexcept { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require(context_ ? EVP_DigestInit_ex(context_.get(), algorithm(), nullptr) : 0);
}

Sha256& Sha256::add(std::span<const std::uint8_t> bytes) {
  require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
  return *this;
}

Sha256& Sha256::add(std::string_view text) {
  add(static_cast<std::uint64_t>(text.size()));
  require(EVP_DigestUpdate(context_.get(), text.data(), text.size()));
  return *this;
}

Sha256& Sha256::add(std::uint64_t value) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return add(std::span<const std::uint8_t>(bytes));
}

Sha256& Sha256::add(double value) {
  return add(std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value));
}

Sha256& Sha256::add(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  add(static_cast<std::uint64_t>(values.rows()));
  add(static_cast<std::uint64_t>(values.cols()));
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    for (Eigen::Index row = 0; row < values.rows(); ++row)
      add(values(row, column));
  return *this;
}

Digest Sha256::finish() {
  Digest digest;
  unsigned int size = 0;
  require(EVP_DigestFinal_ex(context_.get(), digest.bytes.data(), &size));
  return digest;
}

/// The block of SHA-256 has 64 bytes.
Digest hmac_sha256(const Digest& key, std::span<const std::uint8_t> message) {
  std::array<std::uint8_t, 64> inner{}, outer{};
  std::copy(key.bytes.begin(), key.bytes.end(), inner.begin());
  outer = inner;
  for (std::uint8_t& byte : inner)
    byte ^= 0x36;
  for (std::uint8_t& byte : outer)
    byte ^= 0x5c;
  const Digest within = Sha256().add(std::span<const std::uint8_t>(inner)).add(message).finish();
  return Sha256().add(std::span<const std::uint8_t>(outer)).add(within).finish();
}

}  // namespace kinship
