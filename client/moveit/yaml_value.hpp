#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace kinship::moveit {

/// A place in a YAML document with its path, so that an error can name it. Members of a missing
/// place are missing too.
class YamlValue {
 public:
  /// Reads a file's documents; leaves out empty ones, as after the last line of an echoed topic.
  /// \throws Failure(NotFound or InvalidInput) that names the file, and the line of a syntax error.
  static std::vector<YamlValue> read_all(const std::filesystem::path& file);

  /// A document converted from a file in another form.
  static YamlValue of_document(const YAML::Node& document, const std::filesystem::path& file) {
    return {document, file.string(), ""};
  }

  /// A member of a map; missing if there is none.
  YamlValue operator[](const std::string& member) const;

  /// The first present one of these; missing if none is.
  YamlValue first_of(std::initializer_list<const char*> members) const;

  bool is_missing() const noexcept { return !node_ || node_.IsNull(); }
  bool is_map() const noexcept { return !is_missing() && node_.IsMap(); }
  bool is_list() const noexcept { return !is_missing() && node_.IsSequence(); }

  /// The members of a map in their order, by name; a duplicate appears twice. A place has the line
  /// of the name. None if it is no map.
  /// \throws Failure(InvalidInput) if a name is no scalar.
  std::vector<std::pair<std::string, YamlValue>> members() const;

  /// The values of a list; none if it is missing.
  /// \throws Failure(InvalidInput) if it is no list.
  std::vector<YamlValue> items() const;

  /// \throws Failure(InvalidInput) if it is missing or no finite number.
  double number() const;
  double number_or(double otherwise) const { return is_missing() ? otherwise : number(); }
  bool flag() const;         ///< true, false, 1, 0 \throws as number()
  std::string text() const;  ///< \throws Failure(InvalidInput) if it is missing or no scalar
  std::string text_or(const std::string& otherwise) const {
    return is_missing() ? otherwise : text();
  }

  /// \throws Failure(InvalidInput), always: "'scene.yaml' line 12, world.collision_objects[0]:
  /// WHY".
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  /// \param line  of the enclosing place, for a missing one; from 1, 0: not known.
  YamlValue(const YAML::Node& node, std::string file, std::string way, int line = 0)
      : node_(node),
        file_(std::move(file)),
        way_(std::move(way)),
        line_(node.Mark().is_null() ? line : node.Mark().line + 1) {}

  YAML::Node node_;
  std::string file_;
  std::string way_;  // empty for the document
  int line_;
};

}  // namespace kinship::moveit
