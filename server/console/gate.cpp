#include "server/console/gate.hpp"

#include <array>
#include <utility>

#include "pages/page/document.hpp"

namespace kinship::console {
namespace {

constexpr std::string_view kToken = "token";
constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kLasts_s = "2592000";  // the cookie: 30 days

http::Reply page(unsigned status, const std::string& head, const std::string& body) {
  return {.status = status,
          .type = std::string(kHtml),
          .body = "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">" + head +
                  "<title>Kinship</title></head>\n<body>" + body + "</body>\n</html>\n"};
}

/// In a quoted attribute.
std::string link_to(const std::string& path, const std::string& text) {
  return "<a href=\"" + page::escaped(path) + "\">" + text + "</a>";
}

bool reads(const http::Request& request) {
  return request.method == "GET" || request.method == "HEAD";
}

}  // namespace

Gate::Gate(std::string token, std::uint16_t port, bool has_tls)
    : token_(std::move(token)),
      cookie_("kinship-console-" + std::to_string(port)),
      has_tls_(has_tls) {}

/// Takes as long for any text of the token's length.
bool Gate::is_token(std::string_view text) const {
  if (text.size() != token_.size())
    return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    difference |= static_cast<unsigned>(text[i] ^ token_[i]);
  return difference == 0;
}

std::string Gate::link(std::string_view url) const {
  return std::string(url) + "/?" + std::string(kToken) + '=' + token_;
}

/// Not by a redirection: where the link stood on another site's page, browsers would go on without
/// the cookie, which is for this site's own steps alone (SameSite=Strict).
http::Reply Gate::let_in(const http::Request& request) const {
  http::Reply reply = page(
      200, "<meta http-equiv=\"refresh\" content=\"0;url=" + page::escaped(request.path) + "\">",
      "<p>" + link_to(request.path, "To the console") + "</p>");
  reply.fields.emplace_back("Set-Cookie", cookie_ + '=' + token_ +
                                              "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" +
                                              std::string(kLasts_s) + (has_tls_ ? "; Secure" : ""));
  return reply;
}

/// Browsers say which site's page sends a request, and for one that changes something its origin.
bool Gate::is_of_other_page(const http::Request& request) const {
  const std::string* const site = request.field("sec-fetch-site");
  const std::string* const mode = request.field("sec-fetch-mode");
  if (site != nullptr && *site != "same-origin" && *site != "none" &&
      !(reads(request) && mode != nullptr && *mode == "navigate"))
    return true;
  if (reads(request))
    return false;
  const std::string* const origin = request.field("origin");
  const std::string* const host = request.field("host");
  return origin == nullptr || host == nullptr ||
         *origin != (has_tls_ ? "https://" : "http://") + *host;
}

std::optional<http::Reply> Gate::stop(const http::Request& request) const {
  if (is_of_other_page(request))
    return http::text_reply(403, "the console answers its own pages only");
  if (const auto given = request.query.find(std::string(kToken)); given != request.query.end()) {
    if (!is_token(given->second))
      return http::text_reply(403, "the token is wrong: 'kinship console' prints the link");
    if (reads(request))
      return let_in(request);
  }
  if (is_token(http::cookie_of(request, cookie_)))
    return std::nullopt;
  if (request.path.starts_with("/api/"))
    return http::text_reply(401, "the console needs its token: 'kinship console' prints the link");
  return page(401, "",
              "<p>The console needs its token. <code>kinship console</code>, on the server's "
              "machine, prints the link.</p><p>If this browser was let in before: " +
                  link_to(request.path, "go on") + "</p>");
}

http::Reply guarded(http::Reply reply) {
  static constexpr std::array<std::pair<const char*, const char*>, 6> kFields = {{
      {"Content-Security-Policy",
       "default-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
       "frame-ancestors 'none'; object-src 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
  }};
  for (const auto& [name, value] : kFields)
    reply.fields.emplace_back(name, value);
  bool is_cached = false;
  for (const auto& [name, value] : reply.fields)
    is_cached = is_cached || name == "Cache-Control";
  if (!is_cached)
    reply.fields.emplace_back("Cache-Control", "no-store");
  return reply;
}

}  // namespace kinship::console
