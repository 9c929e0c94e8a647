#include "robots/geometry/point_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/characters.hpp"
#include "proto/types/failure.hpp"
#include "robots/geometry/number_words.hpp"

namespace kinship::geometry {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Failure(ErrorCode::InvalidInput, what); }

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line))
    words.emplace_back(word);
  return words;
}

/// Collects points, without ones that a sensor did not see.
class Points {
 public:
  void add(const Eigen::Vector3d& point) {
    if (++seen_ > kMaxPoints)
      throw Failure(ErrorCode::TooLarge, "more than " + std::to_string(kMaxPoints) + " points");
    if (point.allFinite())
      numbers_.insert(numbers_.end(), point.data(), point.data() + 3);
  }
  std::size_t seen() const noexcept { return seen_; }
  Eigen::Matrix3Xd matrix() const {
    return Eigen::Map<const Eigen::Matrix3Xd>(numbers_.data(), 3,
                                              static_cast<Eigen::Index>(numbers_.size() / 3));
  }

 private:
  std::vector<double> numbers_;
  std::size_t seen_ = 0;
};

/// \param columns  where x, y and z stand in a line
Points read_lines(std::string_view text, const std::array<std::size_t, 3>& columns,
                  std::size_t line_number) {
  Points points;
  const std::size_t last = *std::max_element(columns.begin(), columns.end());
  for (; !text.empty(); ++line_number) {
    std::string_view line = take_line(text);
    line = line.substr(0, line.find('#'));
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t column = 0; column <= last; ++column) {
      const std::string_view word = take_word(line);
      if (word.empty() && column == 0)
        break;  // an empty line
      const auto axis = std::find(columns.begin(), columns.end(), column) - columns.begin();
      const std::optional<double> number = number_of<double>(word);
      if (word.empty())
        refuse("line " + std::to_string(line_number) + ": has too few numbers");
      if (axis < 3 && !number)
        refuse_word(line_number, word);
      if (axis < 3)
        point[axis] = *number;
      if (column == last)
        points.add(point);
    }
  }
  return points;
}

/// The header of a PCD file, as far as it is about points.
/// Source: the Point Cloud Library, The PCD file format (version 0.7).
struct PcdHeader {
  std::array<std::size_t, 3> columns{};  // of x, y and z, counted in numbers
  std::array<std::size_t, 3> offsets{};  // in a point, bytes
  std::array<std::size_t, 3> sizes{};    // bytes of a number
  std::size_t point_bytes = 0, points = 0, lines = 0;
  bool is_binary = false;
};

using Members = std::map<std::string, std::vector<std::string>>;

std::size_t count_at(const Members& members, const char* name, std::size_t i,
                     std::optional<std::size_t> otherwise = std::nullopt) {
  constexpr std::size_t kMost = 1'000'000'000;
  const auto member = members.find(name);
  if (member == members.end() && otherwise)
    return *otherwise;
  const auto number = member != members.end() && i < member->second.size()
                          ? number_of<std::size_t>(member->second[i])
                          : std::nullopt;
  if (!number || *number > kMost)
    refuse("header: " + std::string(name) + " is missing, too short or no number");
  return *number;
}

void place_fields(const Members& members, PcdHeader& header) {
  const auto fields = members.find("FIELDS");
  if (fields == members.end())
    refuse("header: FIELDS is missing");
  std::size_t found = 0, column = 0;
  for (std::size_t i = 0; i < fields->second.size(); ++i) {
    const std::size_t size = count_at(members, "SIZE", i), count = count_at(members, "COUNT", i, 1);
    const std::string& name = fields->second[i];
    if (name == "x" || name == "y" || name == "z") {
      const auto type = members.find("TYPE");
      if (type == members.end() || i >= type->second.size() || type->second[i] != "F" ||
          (size != sizeof(float) && size != sizeof(double)) || count != 1 ||
          header.sizes[static_cast<std::size_t>(name[0] - 'x')] != 0)
        refuse("header: " + name + " must be there once, one number of TYPE F and SIZE 4 or 8");
      const auto axis = static_cast<std::size_t>(name[0] - 'x');
      header.columns[axis] = column;
      header.offsets[axis] = header.point_bytes;
      header.sizes[axis] = size;
      ++found;
    }
    column += count;
    header.point_bytes += size * count;
    if (header.point_bytes > kMaxCloudBytes)
      refuse("header: a point of " + std::to_string(header.point_bytes) + " bytes");
  }
  if (found != 3)
    refuse("header: FIELDS must name x, y and z once each");
}

/// \param text  the part behind the header is left.
PcdHeader read_header(std::string_view& text) {
  constexpr std::size_t kMaxHeaderLines = 100, kMaxHeaderLine = 4096;
  PcdHeader header;
  Members members;
  while (!text.empty() && !members.contains("DATA")) {
    const std::string_view line = take_line(text);
    if (++header.lines > kMaxHeaderLines || line.size() > kMaxHeaderLine)
      refuse("header: more than " + std::to_string(kMaxHeaderLines) + " lines of " +
             std::to_string(kMaxHeaderLine) + " bytes");
    std::vector<std::string> words = words_of(line);
    if (words.empty() || words.front().starts_with('#'))
      continue;
    std::string name = std::move(words.front());
    words.erase(words.begin());
    members[std::move(name)] = std::move(words);
  }
  place_fields(members, header);
  const std::vector<std::string>& data = members["DATA"];
  if (data != std::vector<std::string>{"ascii"} && data != std::vector<std::string>{"binary"})
    refuse("header: DATA must be ascii or binary, not '" +
           (data.empty() ? std::string() : printable_start(data.front())) + "'");
  header.is_binary = data.front() == "binary";
  header.points = count_at(members, "POINTS", 0);
  return header;
}

Eigen::Matrix3Xd read_pcd(std::string_view text) {
  const PcdHeader header = read_header(text);
  if (!header.is_binary) {
    const Points points = read_lines(text, header.columns, header.lines + 1);
    if (points.seen() < header.points)
      refuse(std::to_string(header.points) + " points are announced, " +
             std::to_string(points.seen()) + " follow");
    return points.matrix();
  }
  if (text.size() / header.point_bytes < header.points)
    refuse(std::to_string(header.points) + " points of " + std::to_string(header.point_bytes) +
           " bytes are announced, " + std::to_string(text.size()) + " bytes follow");
  Points points;
  for (std::size_t i = 0; i < header.points; ++i) {
    Eigen::Vector3d point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const char* const bytes = text.data() + i * header.point_bytes + header.offsets[axis];
      float single = 0;
      double number = 0;
      if (header.sizes[axis] == sizeof single) {
        std::memcpy(&single, bytes, sizeof single);
        number = single;
      } else {
        std::memcpy(&number, bytes, sizeof number);
      }
      point[static_cast<Eigen::Index>(axis)] = number;
    }
    points.add(point);
  }
  return points.matrix();
}

constexpr int kLevels = 16;
constexpr double kInset = 1e-6;  // of an edge: a body at a cube's face does not touch the next cube
constexpr std::size_t kMaxCubes = 1'000'000;  // eight corners each
constexpr double kMinEdge_m = 1e-4, kMaxEdge_m = 100;

[[noreturn]] void refuse_map(const std::string& what) {
  throw Failure(ErrorCode::InvalidInput, what);
}

struct Header {
  bool has_probabilities = false;
  double edge_m = 0;  // of the smallest cubes
};

/// Cuts the head off a file: lines of words, until one that says "data".
Header take_header(std::string_view& file) {
  constexpr int kMaxLines = 100;
  Header header;
  std::string id;
  for (int number = 0; number < kMaxLines; ++number) {
    const std::size_t end = file.find('\n');
    if (end == std::string_view::npos)
      refuse_map("header: no line 'data'");
    std::string_view line = file.substr(0, end);
    file.remove_prefix(end + 1);
    if (number == 0) {
      header.has_probabilities = line.starts_with("# Octomap OcTree file");
      if (!header.has_probabilities && !line.starts_with("# Octomap OcTree binary file"))
        refuse_map(
            "header: is no OctoMap, its first line is not '# Octomap OcTree file' or '# Octomap "
            "OcTree binary file'");
    } else if (line.starts_with("id ")) {
      id = line.substr(3);
    } else if (line.starts_with("res ")) {
      line.remove_prefix(4);
      std::from_chars(line.data(), line.data() + line.size(), header.edge_m);
    } else if (line == "data") {
      if (id != "OcTree")
        refuse_map("header: id must be OcTree, not '" + printable_start(id) + "'");
      if (!(header.edge_m >= kMinEdge_m && header.edge_m <= kMaxEdge_m))
        refuse_map("header: res must be an edge of 0.0001 to 100 m");
      return header;
    }
  }
  refuse_map("header: more than " + std::to_string(kMaxLines) + " lines before 'data'");
}

/// The tree of a map, read node by node as it was written: children before siblings.
class MapReader {
 public:
  MapReader(std::string_view bytes, const Header& header) : bytes_(bytes), header_(header) {}

  FilePoints read() {
    if (!bytes_.empty()) {
      if (header_.has_probabilities)
        read_node(Eigen::Vector3d::Zero(), 0);
      else
        read_inner(Eigen::Vector3d::Zero(), 0);
    }
    if (!bytes_.empty())
      refuse_map("data: " + std::to_string(bytes_.size()) + " bytes follow the tree");
    return {Eigen::Map<const Eigen::Matrix3Xd>(numbers_.data(), 3,
                                               static_cast<Eigen::Index>(numbers_.size() / 3)),
            header_.edge_m};
  }

 private:
  template <typename Number>
  Number take() {
    Number number{};
    if (bytes_.size() < sizeof number)
      refuse_map("data: ends within a node");
    std::memcpy(&number, bytes_.data(), sizeof number);
    bytes_.remove_prefix(sizeof number);
    return number;
  }

  /// How many of the smallest cubes an edge has at a depth.
  static int cubes_across(int depth) { return 1 << (kLevels - depth); }

  Eigen::Vector3d child_of(const Eigen::Vector3d& center, int depth, unsigned child) const {
    const double step_m = header_.edge_m * cubes_across(depth) / 4;
    return center + step_m * Eigen::Vector3d((child & 1U) != 0 ? 1 : -1, (child & 2U) != 0 ? 1 : -1,
                                             (child & 4U) != 0 ? 1 : -1);
  }

  static void check_depth(int depth) {
    if (depth >= kLevels)
      refuse_map("data: is deeper than 16 levels");
  }

  /// Of a node without probabilities: two bits for each child.
  void read_inner(const Eigen::Vector3d& center, int depth) {
    check_depth(depth);
    constexpr unsigned kOccupied = 2, kInner = 3;  // 0: unknown, 1: free
    const auto children = take<std::uint16_t>();
    for (unsigned child = 0; child < 8; ++child)
      if (((children >> (2 * child)) & 3U) == kOccupied)
        add_cube(child_of(center, depth, child), depth + 1);
    for (unsigned child = 0; child < 8; ++child)
      if (((children >> (2 * child)) & 3U) == kInner)
        read_inner(child_of(center, depth, child), depth + 1);
  }

  /// Of a node with a probability, as the logarithm of its odds: one bit for each child.
  void read_node(const Eigen::Vector3d& center, int depth) {
    const auto log_odds = take<float>();
    const auto children = take<std::uint8_t>();
    if (std::isnan(log_odds))
      refuse_map("data: a node's probability is no number");
    if (children == 0 && log_odds >= 0)
      add_cube(center, depth);
    if (children != 0)
      check_depth(depth);
    for (unsigned child = 0; child < 8; ++child)
      if (((children >> child) & 1U) != 0)
        read_node(child_of(center, depth, child), depth + 1);
  }

  /// The corners of all smallest cubes that a cube holds.
  void add_cube(const Eigen::Vector3d& center, int depth) {
    const auto across = static_cast<std::size_t>(cubes_across(depth));
    cubes_ += across * across * across;
    if (across > kMaxCubes || cubes_ > kMaxCubes)
      throw Failure(ErrorCode::TooLarge, "more than " + std::to_string(kMaxCubes) +
                                             " of its smallest cubes are occupied");
    std::vector<double> steps_m;
    for (std::size_t i = 0; i < across; ++i) {
      const double low = static_cast<double>(i) - static_cast<double>(across) / 2;
      steps_m.push_back(header_.edge_m * (low + kInset));
      steps_m.push_back(header_.edge_m * (low + 1 - kInset));
    }
    for (const double x : steps_m)
      for (const double y : steps_m)
        for (const double z : steps_m)
          numbers_.insert(numbers_.end(), {center.x() + x, center.y() + y, center.z() + z});
  }

  std::string_view bytes_;
  const Header header_;
  std::vector<double> numbers_;
  std::size_t cubes_ = 0;  // of the smallest, that are occupied
};

}  // namespace

FilePoints read_octomap(std::string_view file) {
  const Header header = take_header(file);
  return MapReader(file, header).read();
}

Result<FilePoints> read_points(std::string_view file, std::string_view ending) {
  try {
    if (ending == "bt" || ending == "ot")
      return read_octomap(file);
    if (ending == "pcd")
      return FilePoints{read_pcd(file)};
    if (ending == "xyz" || ending == "txt")
      return FilePoints{read_lines(file, {0, 1, 2}, 1).matrix()};
    return Error{ErrorCode::InvalidInput,
                 "is a point cloud of a kind that is not known here; known: xyz, txt, pcd, bt, ot"};
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::geometry
