#include "robots/kinematics/urdf_markup.hpp"

#include <algorithm>
#include <string>

#include "proto/types/limits.hpp"

namespace kinship::kinematics {
namespace {

bool is_forbidden_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7F;
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

Error too_large(std::string_view what, std::size_t value, std::size_t limit) {
  return {ErrorCode::TooLarge, "URDF: " + std::to_string(value) + " " + std::string(what) +
                                   " exceed " + std::to_string(limit)};
}

/// Walks over the tags of a text. Stricter than the parser that comes after: whatever the two
/// could read differently is refused.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  std::optional<Error> scan() {
    while ((at_ = text_.find('<', at_)) != std::string_view::npos)
      if (auto error = scan_tag())
        return error;
    return std::nullopt;
  }

 private:
  bool looking_at(std::string_view start) const { return text_.substr(at_).starts_with(start); }

  Error malformed(const std::string& why) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<long>(at_), '\n');
    return {ErrorCode::InvalidInput, "URDF: line " + std::to_string(line) + ": " + why};
  }

  std::optional<Error> scan_tag() {
    if (looking_at("<!--"))
      return skip_past("<!--", "-->");
    if (looking_at("<![CDATA["))
      return skip_past("<![CDATA[", "]]>");
    if (looking_at("<!"))
      return malformed("document types and entities are not accepted");
    if (looking_at("<?"))
      return scan_instruction();
    if (looking_at("</"))
      return scan_end();
    return scan_start();
  }

  std::optional<Error> skip_past(std::string_view start, std::string_view end) {
    const std::size_t found = text_.find(end, at_ + start.size());
    if (found == std::string_view::npos)
      return malformed("'" + std::string(start) + "' without '" + std::string(end) + "'");
    at_ = found + end.size();
    return std::nullopt;
  }

  std::optional<Error> scan_instruction() {
    const std::size_t end = text_.find_first_of("<>", at_ + 2);
    if (end == std::string_view::npos || text_[end] != '>' || text_[end - 1] != '?')
      return malformed("'<?' without '?>'");
    at_ = end + 1;
    return std::nullopt;
  }

  std::optional<Error> scan_end() {
    const std::size_t end = text_.find_first_of("<>", at_ + 2);
    if (end == std::string_view::npos || text_[end] != '>')
      return malformed("an end tag without '>'");
    if (--depth_ < 0)
      return malformed("an end tag without its start tag");
    at_ = end + 1;
    return std::nullopt;
  }

  std::optional<Error> scan_start() {
    const std::size_t name_end = text_.find_first_of(" \t\r\n/><=\"'", at_ + 1);
    if (name_end == std::string_view::npos || name_end == at_ + 1)
      return malformed("'<' without the name of an element");
    if (text_.substr(at_ + 1, name_end - at_ - 1) == "link" && ++links_ > kMaxUrdfLinks)
      return too_large("links", static_cast<std::size_t>(links_), kMaxUrdfLinks);
    std::size_t attributes = 0;
    std::size_t end = name_end;
    for (; end < text_.size() && text_[end] != '>'; ++end) {
      if (text_[end] == '<')
        return malformed("'<' inside a tag");
      if (text_[end] != '"' && text_[end] != '\'')
        continue;
      if (++attributes > kMaxUrdfAttributes)
        return too_large("attributes of one element", attributes, kMaxUrdfAttributes);
      const std::size_t quote = text_.find_first_of(text_[end] == '"' ? "\"<" : "'<", end + 1);
      if (quote == std::string_view::npos || text_[quote] == '<')
        return malformed("an attribute whose quote does not end");
      end = quote;
    }
    if (end >= text_.size())
      return malformed("a tag without '>'");
    if (auto error = check_unquoted(text_.substr(name_end, end - name_end)))
      return error;
    if (text_[end - 1] != '/' && ++depth_ > kMaxUrdfDepth)
      return too_large("nested elements", static_cast<std::size_t>(depth_), kMaxUrdfDepth);
    at_ = end + 1;
    return std::nullopt;
  }

  /// Every '=' outside quotes must be followed by a quote, so that quotes count the attributes.
  std::optional<Error> check_unquoted(std::string_view inside) const {
    char quote = 0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const char c = inside[i];
      if (quote != 0) {
        if (c == quote)
          quote = 0;
        continue;
      }
      if (c == '"' || c == '\'')
        quote = c;
      if (c != '=')
        continue;
      std::size_t next = i + 1;
      while (next < inside.size() && is_space(inside[next]))
        ++next;
      if (next == inside.size() || (inside[next] != '"' && inside[next] != '\''))
        return malformed("an attribute's value without quotes");
    }
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int links_ = 0;
};

/// The text between an attribute's quotes.
std::string normalized_value(std::string_view value) {
  std::string text(value);
  std::ranges::replace_if(text, is_space, ' ');
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos || text.find_first_not_of("0123456789+-.eE ") != std::string::npos)
    return text;
  return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

}  // namespace

std::optional<Error> check_markup(std::string_view text) {
  if (text.empty())
    return Error{ErrorCode::InvalidInput, "URDF: text is empty"};
  if (text.size() > kMaxUrdfBytes)
    return too_large("bytes", text.size(), kMaxUrdfBytes);
  const auto control = std::find_if(text.begin(), text.end(), is_forbidden_control);
  if (control != text.end())
    return Error{
        ErrorCode::InvalidInput,
        "URDF: byte " + std::to_string(control - text.begin() + 1) + " is a control character"};
  return Scanner(text).scan();
}

std::string normalize_attributes(std::string_view text) {
  std::string normalized;
  normalized.reserve(text.size());
  const auto copy_until = [&](std::size_t& at, std::size_t end) {
    end = std::min(end, text.size());
    normalized += text.substr(at, end - at);
    at = end;
  };
  std::size_t at = 0;
  for (copy_until(at, text.find('<')); at < text.size(); copy_until(at, text.find('<', at))) {
    if (text.compare(at, 4, "<!--") == 0) {
      copy_until(at, text.find("-->", at));
    } else if (text.compare(at, 9, "<![CDATA[") == 0) {
      copy_until(at, text.find("]]>", at));
    } else {
      copy_until(at, text.find_first_of("\"'>", at));
      while (at < text.size() && text[at] != '>') {
        const std::size_t end = std::min(text.find(text[at], at + 1), text.size());
        normalized += text[at] + normalized_value(text.substr(at + 1, end - at - 1));
        at = end;
        copy_until(at, text.find_first_of("\"'>", at + 1));
      }
    }
  }
  return normalized;
}

}  // namespace kinship::kinematics
