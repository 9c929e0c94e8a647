#include "proto/files/lines.hpp"

#include <cerrno>
#include <exception>
#include <istream>
#include <optional>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::files {
namespace {

using Traits = std::char_traits<char>;

struct RawLine {
  std::string text;
  bool is_too_long = false;
};

/// \return empty at the end of the file.
std::optional<RawLine> read_line(std::streambuf& buffer, std::size_t max_bytes) {
  Traits::int_type c = buffer.sbumpc();
  if (Traits::eq_int_type(c, Traits::eof()))
    return std::nullopt;
  RawLine line;
  for (; !Traits::eq_int_type(c, Traits::eof()) && Traits::to_char_type(c) != '\n';
       c = buffer.sbumpc()) {
    if (line.text.size() == max_bytes)
      line.is_too_long = true;
    else
      line.text.push_back(Traits::to_char_type(c));
  }
  return line;
}

bool is_blank(const RawLine& line) {
  return !line.is_too_long && line.text.find_first_not_of(" \t\r") == std::string::npos;
}

}  // namespace

void for_each_line(std::istream& stream, const std::string& name,
                   const std::function<bool(const Line&)>& use, std::size_t max_bytes) {
  std::size_t number = 0;
  const auto next = [&] {
    ++number;
    try {
      return read_line(*stream.rdbuf(), max_bytes);
    } catch (const std::exception& error) {  // of the stream's buffer: the system's message
      throw Failure(ErrorCode::Storage, "cannot read '" + name + "' at line " +
                                            std::to_string(number) + ": " + error.what());
    }
  };
  while (std::optional<RawLine> line = next()) {
    if (is_blank(*line))
      continue;
    const bool go_on =
        line->is_too_long
            ? use({number,
                   Error{ErrorCode::TooLarge, "more than " + std::to_string(max_bytes) + " bytes"}})
            : use({number, std::move(line->text)});
    if (!go_on)
      return;
  }
}

std::ifstream open_input(const std::filesystem::path& file) {
  std::error_code unknown;  // then opening says it
  if (std::filesystem::is_directory(file, unknown))
    throw Failure(ErrorCode::InvalidInput, "cannot read '" + file.string() + "': it is a folder");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Failure(ErrorCode::NotFound,
                  "cannot read '" + file.string() + "': " + std::system_category().message(errno));
  return stream;
}

}  // namespace kinship::files
