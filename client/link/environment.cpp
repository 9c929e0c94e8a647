#include "client/link/environment.hpp"

#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

constexpr std::uint32_t kMaxDomain = 230;  // DDS has no ports for higher ones

}  // namespace

std::filesystem::path security_from_environment() {
  const char* const folder = std::getenv("KINSHIP_SECURITY");
  return folder != nullptr ? folder : "";
}

std::filesystem::path token_from_environment() {
  const char* const file = std::getenv("KINSHIP_TOKEN");
  return file != nullptr ? file : "";
}

ClientOptions options_from_environment() {
  ClientOptions options;
  if (const char* const text = std::getenv("KINSHIP_DOMAIN"); text != nullptr && *text != '\0') {
    const std::string_view digits = text;
    const char* const end = digits.data() + digits.size();
    const auto [stopped, error] = std::from_chars(digits.data(), end, options.domain);
    if (error != std::errc() || stopped != end || options.domain > kMaxDomain)
      throw Failure(ErrorCode::InvalidInput, "KINSHIP_DOMAIN '" + std::string(digits) +
                                                 "' is not a domain from 0 to " +
                                                 std::to_string(kMaxDomain));
  }
  if (const char* const host = std::getenv("KINSHIP_SERVER"); host != nullptr && *host != '\0')
    options.server = host;
  options.security = security_from_environment();
  return options;
}

}  // namespace kinship::link
