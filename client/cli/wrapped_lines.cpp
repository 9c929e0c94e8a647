#include "client/cli/wrapped_lines.hpp"

#include <algorithm>

#include "proto/types/characters.hpp"

namespace kinship::cli {
namespace {

/// Where the text behind a label begins; two more than the line's own indent without a label.
std::size_t indent_of(std::string_view line) {
  constexpr std::size_t kMaxLabel = 24, kStep = 2;
  const std::size_t first = line.find_first_not_of(' ');
  const std::size_t gap = line.find("  ", first);
  if (gap < kMaxLabel)
    if (const std::size_t text = line.find_first_not_of(' ', gap); text < kMaxLabel)
      return text;
  return first + kStep;
}

}  // namespace

std::string wrapped(std::string_view line, std::size_t width) {
  const std::size_t first = line.find_first_not_of(' ');
  if (character_count(line) <= width || first == std::string_view::npos ||
      std::string_view("{[<\"").find(line[first]) != std::string_view::npos)
    return std::string(line);
  const std::size_t indent = std::min(indent_of(line), width / 2);
  std::string text(line.substr(0, first));
  std::size_t used = first;
  bool is_first = true;  // word of its line
  for (std::size_t at = first; at < line.size();) {
    const std::size_t word = line.find_first_not_of(' ', at);
    if (word == std::string_view::npos)
      break;
    const std::size_t end = std::min(line.find(' ', word), line.size());
    const std::size_t gap = word - at;
    const std::size_t length = character_count(line.substr(word, end - word));
    if (!is_first && used + gap + length > width) {
      text += '\n' + std::string(indent, ' ');
      used = indent;
    } else {
      text += std::string(gap, ' ');
      used += gap;
    }
    text += line.substr(word, end - word);
    used += length;
    is_first = false;
    at = end;
  }
  return text;
}

WrappedLines::WrappedLines(std::ostream& out, std::size_t width)
    : out_(out),
      behind_(out.rdbuf()),
      width_(width),
      is_unbuffered_((out.flags() & std::ios_base::unitbuf) != 0) {
  out_.rdbuf(this);
  out_ << std::nounitbuf;
}

WrappedLines::~WrappedLines() {
  put_line(false);
  out_.rdbuf(behind_);
  if (is_unbuffered_)
    out_ << std::unitbuf << std::flush;
}

WrappedLines::int_type WrappedLines::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof()))
    return traits_type::not_eof(c);
  if (traits_type::to_char_type(c) == '\n')
    put_line(true);
  else
    line_ += traits_type::to_char_type(c);
  return c;
}

int WrappedLines::sync() {
  put_line(false);
  return behind_->pubsync();
}

void WrappedLines::put_line(bool ends) {
  const bool is_whole = ends && !is_begun_;
  std::string text = is_whole ? wrapped(line_, width_) : line_;
  is_begun_ = !ends && (is_begun_ || !line_.empty());
  line_.clear();
  if (ends)
    text += '\n';
  behind_->sputn(text.data(), static_cast<std::streamsize>(text.size()));
  if (ends && is_unbuffered_)
    behind_->pubsync();
}

}  // namespace kinship::cli
