#include "proto/codec/recall_codec.hpp"

#include <algorithm>
#include <string>
#include <tuple>

#include "proto/codec/fields.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/pose.hpp"

namespace kinship::codec {
namespace {

constexpr std::size_t kNumbersOfAnchor = std::tuple_size_v<PoseArray>;

void write_configuration(const Eigen::VectorXd& q, Arena& arena, dds_sequence_double& wire) {
  write_numbers(arena, q.data(), static_cast<std::size_t>(q.size()), wire);
}

Eigen::VectorXd read_configuration(const char* what, std::span<const double> numbers,
                                   Reader& reader) {
  reader.rules.at_most(what, numbers.size(), kMaxDof);
  if (reader.rules.broken())
    return {};
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
}

/// \param numbers  seven a pose.
std::vector<Eigen::Isometry3d> read_anchors(std::span<const double> numbers, Reader& reader) {
  reader.rules
      .that(numbers.size() % kNumbersOfAnchor == 0,
            "recall: T_task_anchors: " + std::to_string(numbers.size()) +
                " numbers are not a multiple of 7")
      .at_most("recall: T_task_anchors", numbers.size() / kNumbersOfAnchor, kMaxRecallAnchors);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < numbers.size() && !reader.rules.broken(); i += kNumbersOfAnchor)
    poses.push_back(
        reader.pose("recall: T_task_anchors", numbers.subspan(i).first<kNumbersOfAnchor>()));
  return poses;
}

}  // namespace

static void write_part(const RecallQuery& query, Arena& arena, kinship_wire_RecallQuery& wire) {
  write_uuid(query.report, wire.report);
  wire.is_synthetic = query.is_synthetic;
  write_pose(query.T_task_base, wire.T_task_base);
  write_configuration(query.start, arena, wire.start);
  write_configuration(query.goal, arena, wire.goal);
  arena.resize(wire.T_task_anchors, kNumbersOfAnchor * query.T_task_anchors.size());
  double* next = wire.T_task_anchors._buffer;
  for (const Eigen::Isometry3d& T_task_anchor : query.T_task_anchors)
    next = std::ranges::copy(to_pose_array(T_task_anchor), next).out;
}

static void read_part(const kinship_wire_RecallQuery& wire, Reader& reader, RecallQuery& query) {
  query.report = read_uuid(wire.report);
  query.is_synthetic = wire.is_synthetic;
  query.T_task_base = reader.pose("recall: T_task_base", wire.T_task_base);
  query.start = read_configuration("recall: start", elements(wire.start), reader);
  query.goal = read_configuration("recall: goal", elements(wire.goal), reader);
  query.T_task_anchors = read_anchors(elements(wire.T_task_anchors), reader);
}

static void write_part(const RecallPath& path, Arena& arena, kinship_wire_RecallPath& wire) {
  wire.query = path.query;
  arena.resize(wire.waypoints, static_cast<std::size_t>(path.waypoints.size()));
  std::copy_n(path.waypoints.data(), path.waypoints.size(), wire.waypoints._buffer);
}

static void read_part(const kinship_wire_RecallPath& wire, Reader& reader, RecallPath& path) {
  path.query = wire.query;
  const auto numbers = elements(wire.waypoints);
  reader.rules
      .that(numbers.size() % kRecallWaypoints == 0,
            "recall: waypoints: " + std::to_string(numbers.size()) +
                " numbers are not a multiple of " + std::to_string(kRecallWaypoints))
      .at_most("recall: joints of waypoints", numbers.size() / kRecallWaypoints, kMaxDof);
  if (reader.rules.broken())
    return;
  path.waypoints = Eigen::Map<const Eigen::MatrixXf>(
                       numbers.data(), std::ssize(numbers) / kRecallWaypoints, kRecallWaypoints)
                       .cast<double>();
}

static void write_part(const WarpMode& mode, Arena& /*arena*/, kinship_wire_WarpMode& wire) {
  wire = {mode.blend, mode.frame};
}

static void read_part(const kinship_wire_WarpMode& wire, Reader& /*reader*/, WarpMode& mode) {
  mode = {wire.blend, wire.frame};
}

void write_part(const RecallLibrary& library, Arena& arena, kinship_wire_RecallLibrary& wire) {
  wire.revision = library.revision;
  wire.search_checks = library.search_checks;
  wire.try_checks = library.try_checks;
  write_value(library.anchors, {}, arena, wire.anchors);
  write_value(library.queries, {}, arena, wire.queries);
  write_value(library.paths, {}, arena, wire.paths);
  write_value(library.modes, {}, arena, wire.modes);
  write_value(library.solves, {}, arena, wire.solves);
  write_value(library.reaches, {}, arena, wire.reaches);
}

void read_part(const kinship_wire_RecallLibrary& wire, Reader& reader, RecallLibrary& library) {
  constexpr std::size_t kMaxSolves = kMaxRecallQueries * kMaxRecallPaths * kMaxWarpModes / 8;
  const auto read = [&reader]<typename T>(const char* name, const auto& member, std::size_t limit,
                                          std::vector<T>& values) {
    values = read_value<std::vector<T>>({name}, member, {.limit = limit}, reader);
  };
  library.revision = wire.revision;
  library.search_checks = wire.search_checks;
  library.try_checks = wire.try_checks;
  read("recall: anchors", wire.anchors, kMaxRecallAnchors, library.anchors);
  read("recall: queries", wire.queries, kMaxRecallQueries, library.queries);
  read("recall: paths", wire.paths, kMaxRecallPaths, library.paths);
  read("recall: modes", wire.modes, kMaxWarpModes, library.modes);
  const auto read_bits = [&reader](const char* name, const auto& member,
                                   std::vector<std::uint8_t>& bits) {
    const auto bytes = elements(member);
    reader.rules.at_most(name, bytes.size(), kMaxSolves);
    if (!reader.rules.broken())
      bits.assign(bytes.begin(), bytes.end());
  };
  read_bits("recall: solves", wire.solves, library.solves);
  read_bits("recall: reaches", wire.reaches, library.reaches);
}

}  // namespace kinship::codec
