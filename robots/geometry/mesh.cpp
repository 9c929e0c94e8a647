#include "robots/geometry/mesh.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/characters.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/number_words.hpp"

namespace kinship::geometry {
namespace {

constexpr std::size_t kStlHeaderBytes = 80;
constexpr std::size_t kStlFacetBytes = 50;  // normal, three corners, two bytes of attributes
constexpr std::size_t kStlStart = kStlHeaderBytes + sizeof(std::uint32_t);

bool is_stl_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

bool is_word(std::string_view word, std::string_view keyword) {
  return std::ranges::equal(word, keyword, [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

Eigen::Matrix3Xd as_columns(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3,
                                            static_cast<Eigen::Index>(values.size() / 3));
}

Error too_many_facets() {
  return {ErrorCode::TooLarge, "more than " + std::to_string(kMaxMeshTriangles) + " triangles"};
}

/// The words of an STL in text form.
class StlText {
 public:
  explicit StlText(std::string_view text) : text_(text) {}

  Eigen::Matrix3Xd read() {
    require("solid");
    skip_line();
    std::vector<double> values;
    for (bool is_open = true; is_open || !peek().empty();) {
      if (is_word(peek(), "solid") && !is_open) {
        skip_line();
        is_open = true;
      } else if (is_word(peek(), "endsolid") && is_open) {
        skip_line();
        is_open = false;
      } else if (!is_open) {
        refuse("'solid' is expected");
      } else {
        read_facet(values);
      }
    }
    return as_columns(values);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) {
    const std::string word = printable_start(peek());
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(at_);
    throw Failure(
        ErrorCode::InvalidInput,
        "line " + std::to_string(1 + std::count(text_.begin(), end, '\n')) + ": " + what +
            (word.empty() ? ", and the file ends here: is it cut off?" : ", not '" + word + "'"));
  }

  /// The next word; empty at the end.
  std::string_view peek() {
    while (at_ < text_.size() && is_stl_blank(text_[at_]))
      ++at_;
    std::size_t end = at_;
    while (end < text_.size() && !is_stl_blank(text_[end]))
      ++end;
    return text_.substr(at_, end - at_);
  }

  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void require(std::string_view keyword) {
    if (!is_word(peek(), keyword))
      refuse("'" + std::string(keyword) + "' is expected");
    at_ += keyword.size();
  }

  float number() {
    std::string_view word = peek();
    const std::size_t size = word.size();
    if (word.starts_with('+'))
      word.remove_prefix(1);
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    // A number too small for a float is zero; one too large is refused.
    if (error == std::errc::invalid_argument || end != word.data() + word.size() ||
        (error == std::errc::result_out_of_range && !is_tiny(word)))
      refuse(word.find(',') == std::string_view::npos
                 ? "a number is expected"
                 : "a number is expected (decimal commas are not read)");
    at_ += size;
    return value;
  }

  static bool is_tiny(std::string_view word) {
    double value = 1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && value < 1 && value > -1;
  }

  void read_facet(std::vector<double>& values) {
    require("facet");
    require("normal");
    for (int i = 0; i < 3 && !is_word(peek(), "outer"); ++i)  // computed anew from the corners
      at_ += peek().size();
    require("outer");
    require("loop");
    for (int corner = 0; corner < 3; ++corner) {
      require("vertex");
      for (int axis = 0; axis < 3; ++axis)
        values.push_back(static_cast<double>(number()));
    }
    require("endloop");
    require("endfacet");
    if (values.size() > 9 * kMaxMeshTriangles)
      throw Failure(too_many_facets());
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// How many facets the bytes of a binary file announce.
std::size_t announced_facets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kStlHeaderBytes, sizeof count);
  return count;
}

/// Whether a word of the text form stands before the first byte that no text has.
bool looks_like_text(std::string_view bytes) {
  constexpr std::size_t kMaxTitle = 4096;
  const auto trimmed = [](std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  };
  const std::string_view start = trimmed(bytes.substr(0, std::min(bytes.find('\0'), kMaxTitle)));
  const std::string_view next = trimmed(start.substr(std::min(start.find('\n'), start.size())));
  return is_word(start.substr(0, 5), "solid") &&
         (is_word(next.substr(0, 5), "facet") || is_word(next.substr(0, 8), "endsolid"));
}

Result<Eigen::Matrix3Xd> read_binary(std::string_view bytes) {
  const std::size_t count = announced_facets(bytes);
  const std::size_t present = (bytes.size() - kStlStart) / kStlFacetBytes;
  const std::string announced = "announces " + std::to_string(count) + " triangles";
  if (count > present)
    return invalid_input(announced + " and holds " + std::to_string(present) +
                         ": it is cut off, or no STL");
  if (count > kMaxMeshTriangles)
    return too_many_facets();
  const std::string_view rest = bytes.substr(kStlStart + count * kStlFacetBytes);
  if (rest.size() >= kStlFacetBytes && rest.find_first_not_of('\0') != std::string_view::npos)
    return invalid_input(announced + ", and " + std::to_string(rest.size()) +
                         " bytes follow them: there may be more");
  std::vector<double> values;
  values.reserve(9 * count);
  for (std::size_t facet = 0; facet < count; ++facet)
    for (std::size_t i = 3; i < 12; ++i) {  // behind the normal
      float value = 0;
      std::memcpy(&value, bytes.data() + kStlStart + facet * kStlFacetBytes + i * sizeof value,
                  sizeof value);
      values.push_back(static_cast<double>(value));
    }
  return as_columns(values);
}

/// The corners of the triangles of an STL file: 3 x 3 n, three columns per triangle, as in the
/// file, in single precision.
///
/// A file is binary if its length fits the number of facets that it announces, whatever its first
/// 80 bytes are, or if it has no word of the text form. Up to 49 bytes may follow the facets, or
/// any number of zeros. In text, keywords count in either case, and several solids are one mesh.
/// \return InvalidInput with the line or the number of facets for a file that is neither, is
///         truncated, or holds more than it announces; TooLarge above kMaxMeshTriangles.
Result<Eigen::Matrix3Xd> read_stl(std::string_view bytes) {
  const bool has_header = bytes.size() >= kStlStart;
  if (has_header && bytes.size() == kStlStart + announced_facets(bytes) * kStlFacetBytes)
    return read_binary(bytes);
  if (has_header && !looks_like_text(bytes))
    return read_binary(bytes);
  try {
    return StlText(bytes).read();
  } catch (const Failure& failure) {
    return failure.error();
  }
}

constexpr std::array<std::string_view, 3> kFormats = {"stl", "obj", "dae"};

/// The corners of a scene's meshes where its nodes put them.
class Corners {
 public:
  explicit Corners(const aiScene& scene) : scene_(scene) {
    if (scene.mRootNode != nullptr)
      add(*scene.mRootNode, aiMatrix4x4());
  }

  std::size_t triangles() const { return triangles_; }

  Eigen::Matrix3Xd matrix() const {
    return Eigen::Map<const Eigen::Matrix3Xd>(values_.data(), 3,
                                              static_cast<Eigen::Index>(values_.size() / 3));
  }

 private:
  // Assimp's readers limit how deep nodes are nested only by the file's size: no recursion.
  void add(const aiNode& root, const aiMatrix4x4& T_root) {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open = {{&root, T_root}};
    while (!open.empty() && triangles_ <= kMaxMeshTriangles) {
      const auto [node, T_parent] = open.back();
      open.pop_back();
      const aiMatrix4x4 T_node = T_parent * node->mTransformation;
      for (unsigned i = 0; i < node->mNumMeshes && triangles_ <= kMaxMeshTriangles; ++i)
        add(*scene_.mMeshes[node->mMeshes[i]], T_node);
      for (unsigned i = 0; i < node->mNumChildren; ++i)
        open.emplace_back(node->mChildren[i], T_node);
    }
  }

  void add(const aiMesh& mesh, const aiMatrix4x4& T) {
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices < 3)
        continue;  // a point or a line
      triangles_ += face.mNumIndices - 2;
      if (triangles_ > kMaxMeshTriangles)
        return;
      for (unsigned k = 2; k < face.mNumIndices; ++k)  // a fan around the face's first corner
        for (const unsigned at : {0U, k - 1, k})
          add(T * mesh.mVertices[face.mIndices[at]]);
    }
  }

  void add(const aiVector3D& corner) {
    values_.insert(values_.end(), {static_cast<double>(corner.x), static_cast<double>(corner.y),
                                   static_cast<double>(corner.z)});
  }

  const aiScene& scene_;
  std::size_t triangles_ = 0;
  std::vector<double> values_;
};

/// The corners of an OBJ or DAE file.
Result<Eigen::Matrix3Xd> read_with_assimp(std::string_view bytes, const std::string& ending) {
  try {
    ending == "obj" ? require_obj_numbers(bytes) : require_dae_numbers(bytes);
  } catch (const Failure& failure) {
    return failure.error();
  }
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* const scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, ending.c_str());
  if (scene == nullptr)
    return invalid_input(std::string("cannot be read as ") + ending + ": " +
                         importer.GetErrorString());
  const Corners corners(*scene);
  if (corners.triangles() > kMaxMeshTriangles)
    return Error{ErrorCode::TooLarge, std::to_string(corners.triangles()) +
                                          " triangles or more exceed " +
                                          std::to_string(kMaxMeshTriangles)};
  return corners.matrix();
}

}  // namespace

Result<Eigen::Matrix3Xd> read_mesh(std::string_view bytes, std::string_view format) {
  std::string ending(format);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kFormats.begin(), kFormats.end(), ending) == kFormats.end())
    return invalid_input("format '" + std::string(format) + "' is not one of stl, obj, dae");
  if (bytes.size() > kMaxMeshBytes)
    return Error{ErrorCode::TooLarge,
                 std::to_string(bytes.size()) + " bytes exceed " + std::to_string(kMaxMeshBytes)};
  Result<Eigen::Matrix3Xd> corners =
      ending == "stl" ? read_stl(bytes) : read_with_assimp(bytes, ending);
  if (!corners)
    return corners;
  if (corners->cols() == 0)
    return invalid_input("holds no triangles");
  if (!corners->allFinite())
    return invalid_input("holds a coordinate that is not finite");
  return corners;
}

}  // namespace kinship::geometry
