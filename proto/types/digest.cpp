#include "proto/types/digest.hpp"

#include "proto/types/hex.hpp"

namespace kinship {

std::string Digest::hex() const { return to_hex(bytes); }

std::optional<Digest> Digest::from_hex(std::string_view text) {
  Digest digest;
  if (!parse_hex(text, digest.bytes))
    return std::nullopt;
  return digest;
}

}  // namespace kinship
