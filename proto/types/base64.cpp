#include "proto/types/base64.hpp"

#include <openssl/evp.h>

#include <cstddef>

namespace kinship {
namespace {

constexpr std::size_t kBytesOfGroup = 3, kDigitsOfGroup = 4;

}  // namespace

std::string to_base64(std::span<const std::uint8_t> bytes) {
  const std::size_t groups = (bytes.size() + kBytesOfGroup - 1) / kBytesOfGroup;
  std::vector<unsigned char> digits(groups * kDigitsOfGroup + 1);  // and the zero behind it
  const int size = EVP_EncodeBlock(digits.data(), bytes.data(), static_cast<int>(bytes.size()));
  return {digits.begin(), digits.begin() + size};
}

std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text) {
  if (text.size() % kDigitsOfGroup != 0)
    return std::nullopt;
  // OpenSSL takes padding for zeros, and white space at either end for nothing.
  const std::size_t end = text.find_last_not_of('=') + 1;  // of none: 0
  const std::size_t padding = text.size() - end;
  if (padding > 2 || text.substr(0, end).find_first_of("= \t\r\n") != std::string_view::npos)
    return std::nullopt;
  const std::vector<unsigned char> digits(text.begin(), text.end());
  std::vector<std::uint8_t> bytes(text.size() / kDigitsOfGroup * kBytesOfGroup);
  const int size = EVP_DecodeBlock(bytes.data(), digits.data(), static_cast<int>(digits.size()));
  if (size != static_cast<int>(bytes.size()))
    return std::nullopt;
  bytes.resize(bytes.size() - padding);
  return bytes;
}

}  // namespace kinship
