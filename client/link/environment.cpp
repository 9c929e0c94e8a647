#include "client/link/environment.hpp"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

constexpr std::uint32_t kMaxDomain = 230;  // DDS has no ports for higher ones
constexpr double kMinTimeout_s = 0.01, kMaxTimeout_s = 86'400;

/// \return what a variable says; empty: it is not set, or empty.
std::string_view text_of(const char* variable) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? text : "";
}

/// \return the number that a text is, within a range; nothing: it is none.
template <typename Number>
std::optional<Number> number_in(std::string_view text, Number min, Number max) {
  Number number{};
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stopped != text.data() + text.size() ||
      !(number >= min && number <= max))
    return std::nullopt;
  return number;
}

}  // namespace

std::filesystem::path security_from_environment() { return text_of("KINSHIP_SECURITY"); }

std::filesystem::path token_from_environment() { return text_of("KINSHIP_TOKEN"); }

std::uint32_t domain_from_environment() {
  const std::string_view text = text_of("KINSHIP_DOMAIN");
  if (text.empty())
    return ClientOptions().domain;
  const auto domain = number_in<std::uint32_t>(text, 0, kMaxDomain);
  if (!domain)
    throw Failure(ErrorCode::InvalidInput, "KINSHIP_DOMAIN '" + std::string(text) +
                                               "' is not a domain from 0 to " +
                                               std::to_string(kMaxDomain));
  return *domain;
}

std::string server_from_environment() {
  const std::string_view host = text_of("KINSHIP_SERVER");
  return host.empty() ? ClientOptions().server : std::string(host);
}

std::chrono::milliseconds timeout_from_environment() {
  const std::string_view text = text_of("KINSHIP_TIMEOUT");
  if (text.empty())
    return ClientOptions().timeout;
  const auto seconds = number_in(text, kMinTimeout_s, kMaxTimeout_s);
  if (!seconds)
    throw Failure(ErrorCode::InvalidInput,
                  "KINSHIP_TIMEOUT '" + std::string(text) + "' is no time from 0.01 to 86400 s");
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(*seconds));
}

ClientOptions options_from_environment() {
  ClientOptions options;
  options.domain = domain_from_environment();
  options.server = server_from_environment();
  options.timeout = timeout_from_environment();
  options.security = security_from_environment();
  return options;
}

}  // namespace kinship::link
