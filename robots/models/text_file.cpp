#include "robots/models/text_file.hpp"

#include <tinyxml2.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "proto/types/failure.hpp"

namespace kinship::models {
namespace {

/// Elements of a URDF or an SRDF that Kinship reads, or that such ones are in.
bool is_of_model(std::string_view element) {
  constexpr std::array<std::string_view, 25> kElements = {"robot",
                                                          "link",
                                                          "joint",
                                                          "parent",
                                                          "child",
                                                          "origin",
                                                          "axis",
                                                          "limit",
                                                          "mimic",
                                                          "inertial",
                                                          "mass",
                                                          "inertia",
                                                          "visual",
                                                          "collision",
                                                          "box",
                                                          "sphere",
                                                          "cylinder",
                                                          "mesh",
                                                          "geometry",
                                                          "dynamics",
                                                          "safety_controller",
                                                          "group",
                                                          "chain",
                                                          "capsule",
                                                          "disable_collisions"};
  return std::ranges::find(kElements, element) != kElements.end();
}

/// Where xacro begins in a value; npos: nowhere.
std::size_t find_xacro(std::string_view value) {
  constexpr std::array<std::string_view, 3> kMarks = {"${", "$(find", "$(arg"};
  std::size_t first = std::string_view::npos;
  for (const std::string_view mark : kMarks)
    first = std::min(first, value.find(mark));
  return first;
}

/// The first mark of xacro in a document. The content of foreign elements, as of plugins, is not
/// the model's: only an element of xacro's counts there.
class MarkFinder : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const tinyxml2::XMLElement& element,
                  const tinyxml2::XMLAttribute* attribute) override {
    const std::string_view name = element.Name();
    if (foreign_depth_ > 0 || !is_of_model(name))
      ++foreign_depth_;
    if (name.starts_with("xacro:"))
      find(element.GetLineNum(), "<" + std::string(name));
    for (; foreign_depth_ == 0 && attribute != nullptr; attribute = attribute->Next()) {
      const std::string_view value = attribute->Value();
      if (const std::size_t at = find_xacro(value); at != std::string_view::npos)
        find(attribute->GetLineNum(), value.substr(at));
    }
    return mark_.empty();
  }

  bool VisitExit(const tinyxml2::XMLElement&) override {
    foreign_depth_ = std::max(0, foreign_depth_ - 1);
    return mark_.empty();
  }

  const std::string& mark() const { return mark_; }

 private:
  void find(int line, std::string_view text) {
    constexpr std::size_t kShown = 40;  // bytes of the text there
    if (!mark_.empty())
      return;
    const std::string_view shown = text.substr(0, kShown);
    mark_ = "line " + std::to_string(line) + ": '" +
            std::string(shown.substr(0, shown.find_first_of(" />}\"\n\r\t", 2))) + "'";
  }

  int foreign_depth_ = 0;  // how many foreign elements this one is in, itself among them
  std::string mark_;
};

}  // namespace

std::string read_text(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Failure(ErrorCode::NotFound, file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::string text(std::min<std::uintmax_t>(error ? max_bytes : size, max_bytes) + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || (stream.fail() && !stream.eof()))
    throw Failure(ErrorCode::InvalidInput, file.string() + ": cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > max_bytes)
    throw Failure(ErrorCode::TooLarge,
                  file.string() + ": exceeds " + std::to_string(max_bytes) + " bytes");
  return text;
}

std::string xacro_mark(std::string_view text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return {};
  MarkFinder finder;
  document.Accept(&finder);
  return finder.mark();
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
               "'" + file.string() + "' is xacro (" + mark +
                   "), and there is no program xacro in PATH to expand it. " +
                   "It comes with ROS (or: pip install xacro); where it is: xacro " +
                   file.string() + " > " + made.string() +
                   " (arguments as NAME:=VALUE), then give that file"};
}

}  // namespace kinship::models
