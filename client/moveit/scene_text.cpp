#include "client/moveit/scene_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>

#include "proto/types/characters.hpp"
#include "proto/types/failure.hpp"

namespace kinship::moveit {
namespace {

constexpr std::string_view kSceneBlanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSceneBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kSceneBlanks) + 1);
}

/// The lines and words of a scene in text form.
class SceneText {
 public:
  SceneText(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  YAML::Node read() {
    YAML::Node scene(YAML::NodeType::Map);
    scene["name"] = std::string(line());
    YAML::Node objects(YAML::NodeType::Sequence);
    for (std::string_view mark = word("'*' or '.'"); mark != "."; mark = word("'*' or '.'")) {
      if (mark != "*")
        refuse("'*' or '.' is expected, not", mark);
      objects.push_back(object());
    }
    if (const std::string_view rest = without_blanks(text_.substr(at_)); !rest.empty())
      refuse("nothing is expected behind the '.' that ends the scene, but", word("nothing"));
    scene["world"]["collision_objects"] = objects;
    return scene;
  }

 private:
  [[noreturn]] void refuse(const std::string& what, std::string_view found = {}) const {
    const std::string_view before = text_.substr(0, word_at_);
    throw Failure(ErrorCode::InvalidInput,
                  "'" + file_ + "' line " +
                      std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ": " +
                      what + (found.empty() ? "" : " '" + printable_start(found) + "'"));
  }

  /// The rest of the line.
  std::string_view line() {
    word_at_ = at_;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view rest = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    return without_blanks(rest);
  }

  std::string_view word(const std::string& expected) {
    at_ = std::min(text_.find_first_not_of(kSceneBlanks, at_), text_.size());
    word_at_ = at_;
    const std::string_view rest = text_.substr(at_);
    const std::string_view found = rest.substr(0, rest.find_first_of(kSceneBlanks));
    if (found.empty())
      refuse(expected + " is expected, and the file ends here: is it cut off?");
    at_ += found.size();
    return found;
  }

  /// The word of a finite number.
  std::string number() {
    const std::string_view found = word("a number");
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), number_);
    if (error != std::errc() || end != found.data() + found.size() || !std::isfinite(number_))
      refuse("a finite number is expected, not", found);
    return std::string(found);
  }

  std::string size() {
    std::string text = number();
    if (!(number_ > 0))
      refuse("a size above 0 is expected, not", text);
    return text;
  }

  std::size_t count(const std::string& of) {
    const std::string_view found = word("the number of " + of);
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc() || end != found.data() + found.size())
      refuse("the number of " + of + " is expected, not", found);
    if (value > text_.size())
      refuse("more " + of + " than the file has bytes:", found);
    return value;
  }

  YAML::Node numbers(std::size_t count) {
    YAML::Node list(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < count; ++i)
      list.push_back(number());
    return list;
  }

  YAML::Node pose() {
    YAML::Node pose(YAML::NodeType::Map);
    pose["position"] = numbers(3);
    double norm = 0;
    for (int i = 0; i < 4; ++i) {
      pose["orientation"].push_back(number());
      norm = std::hypot(norm, number_);
    }
    constexpr double kTolerance = 1e-2;  // of rounding; further off, another order
    if (std::abs(norm - 1) > kTolerance)
      refuse("is no rotation: the quaternion's norm is " + std::to_string(norm));
    return pose;
  }

  /// Whether an object has a pose of its own: then a line with blanks follows its name.
  bool has_own_pose() const {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    return without_blanks(text_.substr(at_, end - at_)).find(' ') != std::string_view::npos;
  }

  YAML::Node object() {
    YAML::Node object(YAML::NodeType::Map);
    const std::string id(line());
    if (id.empty())
      refuse("an object without a name");
    if (!ids_.insert(id).second)
      refuse("an object that is there already:", id);
    object["id"] = id;
    if (ids_.size() == 1)
      is_newer_ = has_own_pose();
    if (is_newer_)
      object["pose"] = pose();
    const std::size_t shapes = count("shapes");
    if (shapes == 0)
      refuse("an object without shapes:", id);
    for (std::size_t i = 0; i < shapes; ++i)
      add_shape(object);
    const std::size_t subframes = is_newer_ ? count("subframes") : 0;
    for (std::size_t i = 0; i < subframes; ++i) {
      word("the name of a subframe");
      pose();
    }
    return object;
  }

  void add_shape(YAML::Node& object) {
    const std::string type(word("a shape"));
    YAML::Node shape(YAML::NodeType::Map);
    if (type == "mesh") {
      read_mesh(shape);
    } else if (type == "box" || type == "sphere" || type == "cylinder") {
      shape["type"] = type;
      read_sizes(type, shape);
    } else if (type == "cone" || type == "plane" || type == "octree") {
      refuse("a problem cannot say this shape; make a mesh or a box of it, not a", type);
    } else {
      refuse("box, sphere, cylinder or mesh is expected, not", type);
    }
    object[type == "mesh" ? "meshes" : "primitives"].push_back(shape);
    object[type == "mesh" ? "mesh_poses" : "primitive_poses"].push_back(pose());
    numbers(4);  // its colour
  }

  /// A cylinder is written radius first; the message has its height first.
  void read_sizes(const std::string& type, YAML::Node& shape) {
    YAML::Node sizes(YAML::NodeType::Sequence);
    const std::string first = size();
    if (type == "cylinder")
      sizes.push_back(size());
    sizes.push_back(first);
    for (int i = 0; type == "box" && i < 2; ++i)
      sizes.push_back(size());
    shape["dimensions"] = sizes;
  }

  void read_mesh(YAML::Node& mesh) {
    const std::size_t vertices = count("vertices"), triangles = count("triangles");
    if (triangles == 0)
      refuse("a mesh without triangles");
    for (std::size_t i = 0; i < vertices; ++i)
      mesh["vertices"].push_back(numbers(3));
    for (std::size_t i = 0; i < triangles; ++i) {
      YAML::Node corners(YAML::NodeType::Sequence);
      for (int corner = 0; corner < 3; ++corner) {
        const std::size_t vertex = count("a vertex");
        if (vertex >= vertices)
          refuse("none of " + std::to_string(vertices) + " vertices:", std::to_string(vertex));
        corners.push_back(vertex);
      }
      mesh["triangles"].push_back(corners);
    }
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0, word_at_ = 0;
  double number_ = 0;  // the last that was read
  bool is_newer_ = false;
  std::set<std::string> ids_;
};

}  // namespace

std::optional<YAML::Node> read_scene_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream)
    throw Failure(ErrorCode::NotFound, "'" + file.string() + "' cannot be read");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t first = std::min(text.find('\n'), text.size());
  const std::string_view rest = without_blanks(std::string_view(text).substr(first));
  if (file.extension() != ".scene" && !rest.starts_with("* ") && rest != "." &&
      !rest.starts_with("*\t"))
    return std::nullopt;
  return SceneText(text, file.string()).read();
}

}  // namespace kinship::moveit
