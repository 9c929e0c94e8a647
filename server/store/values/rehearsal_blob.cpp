#include "server/store/values/rehearsal_blob.hpp"

#include <stdexcept>
#include <string>

#include "proto/types/limits.hpp"
#include "server/store/values/byte_fields.hpp"

namespace kinship::store {
namespace {

constexpr std::tuple kMadeOf{Field{"kind", &StoredRehearsal::kind},
                             Field{"paths", &StoredRehearsal::paths},
                             Field{"retired", &StoredRehearsal::retired},
                             Field{"T_task_base", &StoredRehearsal::T_task_base},
                             Field{"rehearsal", &StoredRehearsal::rehearsal}};

constexpr std::size_t kMaxBits = kMaxRecallQueries * kMaxRecallPaths * kMaxWarpModes / 8;

void add_bits(ByteWriter& out, const std::vector<std::uint8_t>& bits) {
  out.add(std::uint64_t{bits.size()}).add(std::span<const std::uint8_t>(bits));
}

std::vector<std::uint8_t> read_bits(ByteReader& in) {
  std::vector<std::uint8_t> bits(in.integer(kMaxBits));
  in.bytes(bits);
  return bits;
}

void add_query(ByteWriter& out, const RecallQuery& query) {
  out.add(std::span<const std::uint8_t>(query.report.bytes))
      .add(std::uint64_t{query.is_synthetic ? 1U : 0U})
      .add(std::span<const std::uint8_t>(pose_blob(query.T_task_base)))
      .add(Eigen::MatrixXd(query.start))
      .add(Eigen::MatrixXd(query.goal))
      .add(std::uint64_t{query.T_task_anchors.size()});
  for (const Eigen::Isometry3d& T_task_anchor : query.T_task_anchors)
    out.add(std::span<const std::uint8_t>(pose_blob(T_task_anchor)));
}

RecallQuery read_query(ByteReader& in) {
  RecallQuery query;
  in.bytes(query.report.bytes);
  query.is_synthetic = in.integer() != 0;
  query.T_task_base = in.bare_pose();
  query.start = in.matrix(kMaxDof, 1).reshaped();
  query.goal = in.matrix(kMaxDof, 1).reshaped();
  for (std::size_t left = in.integer(kMaxRecallAnchors); left > 0; --left)
    query.T_task_anchors.push_back(in.bare_pose());
  return query;
}

void add_path(ByteWriter& out, const RecallPath& path) {
  const Eigen::MatrixXf waypoints = path.waypoints.cast<float>();
  out.add(std::uint64_t{path.query})
      .add(static_cast<std::uint64_t>(waypoints.rows()))
      .add(std::span(reinterpret_cast<const std::uint8_t*>(waypoints.data()),
                     static_cast<std::size_t>(waypoints.size()) * sizeof(float)));
}

RecallPath read_path(ByteReader& in) {
  RecallPath path;
  path.query = static_cast<std::uint32_t>(in.integer(kMaxRecallQueries));
  const std::size_t dof = in.integer(kMaxDof);
  Eigen::MatrixXf waypoints(static_cast<Eigen::Index>(dof), kRecallWaypoints);
  in.bytes({reinterpret_cast<std::uint8_t*>(waypoints.data()),
            static_cast<std::size_t>(waypoints.size()) * sizeof(float)});
  path.waypoints = waypoints.cast<double>();
  return path;
}

void add_library(ByteWriter& out, const RecallLibrary& library) {
  out.add(library.revision).add(library.search_checks).add(library.try_checks);
  add_value(out, library.anchors);
  out.add(std::uint64_t{library.queries.size()});
  for (const RecallQuery& query : library.queries)
    add_query(out, query);
  out.add(std::uint64_t{library.paths.size()});
  for (const RecallPath& path : library.paths)
    add_path(out, path);
  out.add(std::uint64_t{library.modes.size()});
  for (const WarpMode& mode : library.modes)
    out.add(std::uint64_t{mode.blend}).add(std::uint64_t{mode.frame});
  add_bits(out, library.solves);
  add_bits(out, library.reaches);
}

RecallLibrary read_library(ByteReader& in) {
  RecallLibrary library;
  library.revision = in.integer();
  library.search_checks = in.real();
  library.try_checks = in.real();
  library.anchors =
      read_value<std::vector<std::string>>(in, kRehearsalVersion, {.limit = kMaxRecallAnchors});
  for (std::size_t left = in.integer(kMaxRecallQueries); left > 0; --left)
    library.queries.push_back(read_query(in));
  for (std::size_t left = in.integer(kMaxRecallPaths); left > 0; --left)
    library.paths.push_back(read_path(in));
  for (std::size_t left = in.integer(kMaxWarpModes); left > 0; --left) {
    const auto blend = static_cast<std::uint32_t>(in.integer(kMaxWarpBlends));
    library.modes.push_back(
        {blend, static_cast<std::uint32_t>(in.integer(kFirstAnchor + kMaxRecallAnchors))});
  }
  library.solves = read_bits(in);
  library.reaches = read_bits(in);
  if (validate(library))
    throw std::out_of_range("rehearsal: its library breaks a rule");
  return library;
}

void read_rehearsal(ByteReader& in, StoredRehearsal& rehearsal) {
  if (in.integer() != kRehearsalVersion)
    throw std::out_of_range("rehearsal: another version");
  read_members(in, kRehearsalVersion, kMadeOf, rehearsal);
  if (in.integer() != 0)
    rehearsal.library = read_library(in);
  if (!in.at_end())
    throw std::out_of_range("rehearsal: bytes left over");
}

}  // namespace

std::vector<std::uint8_t> encode_rehearsal(const StoredRehearsal& rehearsal) {
  ByteWriter out;
  out.add(std::uint64_t{kRehearsalVersion});
  add_members(out, rehearsal, kMadeOf);
  out.add(std::uint64_t{rehearsal.library ? 1U : 0U});
  if (rehearsal.library)
    add_library(out, *rehearsal.library);
  return out.bytes();
}

bool decode_rehearsal(std::span<const std::uint8_t> blob, StoredRehearsal& rehearsal) {
  try {
    ByteReader in(blob);
    read_rehearsal(in, rehearsal);
    return true;
  } catch (const std::out_of_range&) {
    return false;
  }
}

}  // namespace kinship::store
