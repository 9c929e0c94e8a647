#include "robots/models/xacro.hpp"

#include <algorithm>
#include <array>

namespace kinship::models {
namespace {

/// Comments as blanks, so that places and lines stay.
std::string without_comments(std::string_view text) {
  constexpr std::string_view kBegin = "<!--", kEnd = "-->";
  std::string cleared(text);
  for (std::size_t at = cleared.find(kBegin); at != std::string::npos;
       at = cleared.find(kBegin, at)) {
    const std::size_t end = std::min(cleared.find(kEnd, at), cleared.size() - kEnd.size());
    for (; at < end + kEnd.size(); ++at)
      if (cleared[at] != '\n')
        cleared[at] = ' ';
  }
  return cleared;
}

}  // namespace

std::string xacro_mark(std::string_view text) {
  constexpr std::array<std::string_view, 4> kMarks = {"<xacro:", "${", "$(find", "$(arg"};
  constexpr std::size_t kShown = 40;  // bytes of what stands there
  const std::string cleared = without_comments(text);
  std::size_t first = std::string::npos;
  for (const std::string_view mark : kMarks)
    first = std::min(first, cleared.find(mark));
  if (first == std::string::npos)
    return {};
  const auto line =
      1 + std::count(cleared.begin(), cleared.begin() + static_cast<std::ptrdiff_t>(first), '\n');
  std::string shown = cleared.substr(first, kShown);
  shown = shown.substr(0, shown.find_first_of(" />}\"\n\r\t", 2));
  return "line " + std::to_string(line) + ": '" + shown + "'";
}

std::optional<Error> check_expanded(const std::filesystem::path& file, std::string_view text,
                                    std::string_view ending) {
  const std::string mark = xacro_mark(text);
  if (mark.empty())
    return std::nullopt;
  std::filesystem::path made = file.filename();
  if (made.extension() == ".xacro")
    made.replace_extension();
  made.replace_extension(ending);
  if (made == file.filename())
    made.replace_filename(made.stem().string() + "_expanded" + std::string(ending));
  return Error{ErrorCode::InvalidInput,
               "'" + file.string() + "' is xacro (" + mark + "), which is still to be expanded: " +
                   "xacro " + file.string() + " > " + made.string() +
                   " (the program comes with ROS; arguments as NAME:=VALUE), then give that file"};
}

}  // namespace kinship::models
