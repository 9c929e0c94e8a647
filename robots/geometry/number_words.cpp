#include "robots/geometry/number_words.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "proto/types/characters.hpp"
#include "proto/types/failure.hpp"

namespace kinship::geometry {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kXmlBlanks = " \t\r\n";

/// Elements of a DAE file whose text is the numbers of a mesh's corners or of where it lies.
constexpr std::array<std::string_view, 6> kNumberElements = {"float_array", "matrix", "translate",
                                                             "rotate",      "scale",  "lookat"};

/// \param at  where the part begins in `text`
void refuse_comma(std::string_view text, std::size_t at, std::string_view part) {
  const std::size_t comma = part.find(',');
  if (comma == std::string_view::npos)
    return;
  const std::size_t blank = part.substr(0, comma).find_last_of(kXmlBlanks);
  const std::size_t begin = blank == std::string_view::npos ? 0 : blank + 1;
  const std::string_view word = part.substr(begin, part.find_first_of(kXmlBlanks, comma) - begin);
  refuse_word(static_cast<std::size_t>(1 + std::ranges::count(text.substr(0, at + begin), '\n')),
              word);
}

}  // namespace

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

void refuse_word(std::size_t line_number, std::string_view word) {
  const bool has_comma = word.find(',') != std::string_view::npos;
  throw Failure(
      ErrorCode::InvalidInput,
      "line " + std::to_string(line_number) + ": '" + printable_start(word) + "' is no number" +
          (has_comma ? "; decimal commas are not read, and only blanks and tabs part numbers"
                     : ""));
}

void require_obj_numbers(std::string_view text) {
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    std::string_view line = take_line(text);
    if (take_word(line) != "v")
      continue;
    // A remark may follow, and a backslash goes on in the next line.
    for (std::string_view word = take_word(line);
         !word.empty() && word.front() != '#' && word != "\\"; word = take_word(line))
      if (!number_of<double>(word))
        refuse_word(line_number, word);
  }
}

void require_dae_numbers(std::string_view text) {
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at + 1)) {
    const std::string_view tag = text.substr(at, text.find('>', at) - at);
    const std::string_view name = tag.substr(1, tag.find_first_of(" \t\r\n/", 1) - 1);
    if (name == "unit") {
      const std::size_t value = tag.find("meter=");
      if (value != std::string_view::npos && value + 7 < tag.size())
        refuse_comma(text, at + value + 7,
                     tag.substr(value + 7, tag.find(tag[value + 6], value + 7) - value - 7));
    } else if (std::ranges::count(kNumberElements, name) > 0 && at + tag.size() < text.size()) {
      const std::size_t begin = at + tag.size() + 1;
      refuse_comma(text, begin, text.substr(begin, text.find('<', begin) - begin));
    }
  }
}

}  // namespace kinship::geometry
