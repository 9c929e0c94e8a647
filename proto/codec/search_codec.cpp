#include "proto/codec/search_codec.hpp"

#include <algorithm>
#include <string>

#include "proto/codec/fields.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

template <typename Pairs>
std::size_t bytes_of_pairs(const Pairs& pairs) {
  std::size_t bytes = 0;
  for (const auto& pair : elements(pairs))
    bytes += 24 + text_bytes(pair.first) + text_bytes(pair.second);  // as the contract says
  return bytes;
}

/// A sequence of numbers as a matrix of `dof` rows.
template <typename Matrix, typename Sequence>
Matrix read_columns(const char* what, const Sequence& sequence, std::uint32_t dof, Reader& reader) {
  const auto numbers = elements(sequence);
  const std::size_t count = dof == 0 ? 0 : numbers.size() / dof;
  reader.rules.that(count * dof == numbers.size(),
                    "search: " + std::string(what) + ": " + std::to_string(numbers.size()) +
                        " numbers are no multiple of dof " + std::to_string(dof));
  if (reader.rules.broken() || count == 0)
    return Matrix();
  return Eigen::Map<const Matrix>(numbers.data(), dof, static_cast<Eigen::Index>(count));
}

/// The same of none or one configuration.
Eigen::VectorXd read_configuration(const char* what, const dds_sequence_double& sequence,
                                   std::uint32_t dof, Reader& reader) {
  const auto numbers = elements(sequence);
  reader.rules.that(numbers.empty() || numbers.size() == dof,
                    "search: " + std::string(what) + ": has " + std::to_string(numbers.size()) +
                        " joints, not " + std::to_string(dof));
  if (reader.rules.broken())
    return {};
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

}  // namespace

void write_part(const SearchRecord& search, Arena& arena, kinship_wire_SearchRecord& wire) {
  const auto write = [&arena](const auto& matrix, dds_sequence_double& sequence) {
    write_numbers(arena, matrix.data(), static_cast<std::size_t>(matrix.size()), sequence);
  };
  wire.dof = static_cast<std::uint32_t>(dof_of(search));
  write(search.start, wire.start);
  write(search.goals, wire.goals);
  write(search.last_free, wire.last_free);
  write_placement(arena, search.T_task_start, wire.T_task_start);
  write_placement(arena, search.T_task_goal, wire.T_task_goal);
  write_value(search.blockers, {}, arena, wire.blockers);
  write_value(search.goal_contacts, {}, arena, wire.goal_contacts);
  arena.resize(wire.trees, search.trees.size());
  for (std::size_t i = 0; i < search.trees.size(); ++i) {
    const SearchTree& tree = search.trees[i];
    kinship_wire_SearchTree& to = wire.trees._buffer[i];
    arena.resize(to.configurations, static_cast<std::size_t>(tree.configurations.size()));
    std::copy_n(tree.configurations.data(), tree.configurations.size(), to.configurations._buffer);
    arena.resize(to.parents, tree.parents.size());
    std::ranges::copy(tree.parents, to.parents._buffer);
  }
  write_value(search.allowed_collisions, {}, arena, wire.allowed_collisions);
  wire.seed = search.seed;
  wire.reason = arena.text(search.reason);
}

void read_part(const kinship_wire_SearchRecord& wire, Reader& reader, SearchRecord& search) {
  reader.rules.at_most("search (bytes)", search_bytes(wire), kMaxSearchBytes)
      .at_most("search: joints", wire.dof, kMaxDof)
      .at_most("search: trees", elements(wire.trees).size(), kMaxSearchTrees);
  if (reader.rules.broken())
    return;
  search.start = read_configuration("start", wire.start, wire.dof, reader);
  search.last_free = read_configuration("last_free", wire.last_free, wire.dof, reader);
  search.goals = read_columns<Eigen::MatrixXd>("goals", wire.goals, wire.dof, reader);
  search.T_task_start = reader.placement("search: start_pose", elements(wire.T_task_start));
  search.T_task_goal = reader.placement("search: goal_pose", elements(wire.T_task_goal));
  search.blockers = read_value<std::vector<Blocker>>({"search: blockers"}, wire.blockers,
                                                     {.limit = kMaxBlockers}, reader);
  search.goal_contacts = read_value<std::vector<GoalContact>>(
      {"search: goal_contacts"}, wire.goal_contacts, {.limit = kMaxGoalContacts}, reader);
  search.allowed_collisions = read_value<std::vector<NamePair>>(
      {"search: allowed_collisions"}, wire.allowed_collisions, {.limit = kMaxAllowedPairs}, reader);
  for (const kinship_wire_SearchTree& from : elements(wire.trees)) {
    const auto parents = elements(from.parents);
    search.trees.push_back(
        {read_columns<Eigen::MatrixXf>("a tree", from.configurations, wire.dof, reader),
         {parents.begin(), parents.end()}});
  }
  search.seed = wire.seed;
  search.reason = read_text(wire.reason);
}

std::size_t search_bytes(const kinship_wire_SearchRecord& wire) {
  // As the contract says.
  std::size_t bytes =
      128 + text_bytes(wire.reason) + bytes_of_pairs(wire.blockers) +
      bytes_of_pairs(wire.goal_contacts) + bytes_of_pairs(wire.allowed_collisions) +
      sizeof(double) * (elements(wire.start).size() + elements(wire.goals).size() +
                        elements(wire.last_free).size() + elements(wire.T_task_start).size() +
                        elements(wire.T_task_goal).size());
  for (const kinship_wire_SearchTree& tree : elements(wire.trees))
    bytes += 4 * (elements(tree.configurations).size() + elements(tree.parents).size());
  return bytes;
}

}  // namespace kinship::codec
