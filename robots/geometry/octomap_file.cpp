#include "robots/geometry/octomap_file.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "proto/types/characters.hpp"
#include "proto/types/failure.hpp"

namespace kinship::geometry {
namespace {

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

}  // namespace kinship::geometry
