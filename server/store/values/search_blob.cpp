#include "server/store/values/search_blob.hpp"

#include <cstring>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/values/byte_stream.hpp"
#include "server/store/values/compression.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kSearchFormat = 1;  // written first
/// Of the largest record: all but its sizes takes as many bytes here as it counts.
constexpr std::size_t kMaxPlainSearch = kMaxSearchBytes + 1024;

template <typename Number>
Bytes bytes_of(const Number* numbers, std::size_t count) {
  return {reinterpret_cast<const std::uint8_t*>(numbers), count * sizeof(Number)};
}

template <typename Number>
void read_numbers(ByteReader& in, Number* numbers, std::size_t count) {
  in.bytes({reinterpret_cast<std::uint8_t*>(numbers), count * sizeof(Number)});
}

void add(ByteWriter& out, const SearchTree& tree) {
  out.add(std::uint64_t{tree.parents.size()})
      .add(static_cast<std::uint64_t>(tree.configurations.rows()));
  out.add(
      bytes_of(tree.configurations.data(), static_cast<std::size_t>(tree.configurations.size())));
  out.add(bytes_of(tree.parents.data(), tree.parents.size()));
}

SearchTree read_tree(ByteReader& in) {
  const std::size_t count = in.integer(kMaxSearchBytes / sizeof(std::int32_t));
  const std::size_t dof = in.integer(kMaxDof);
  if (count * (dof + 1) > kMaxSearchBytes / sizeof(float))
    throw std::out_of_range("search: a tree exceeds the limit");
  SearchTree tree;
  tree.configurations.resize(static_cast<Eigen::Index>(dof), static_cast<Eigen::Index>(count));
  tree.parents.resize(count);
  read_numbers(in, tree.configurations.data(), count * dof);
  read_numbers(in, tree.parents.data(), count);
  return tree;
}

std::pair<std::string, std::string> read_names(ByteReader& in) {
  std::string first = in.text(kMaxLinkNameBytes);
  return {std::move(first), in.text(kMaxLinkNameBytes)};
}

SearchRecord read_search(ByteReader& in) {
  if (in.integer() != kSearchFormat)
    throw std::out_of_range("search: unknown format");
  SearchRecord search;
  search.start = in.matrix(kMaxDof, 1).reshaped();
  search.goals = in.matrix(kMaxDof, kMaxSearchGoals);
  search.last_free = in.matrix(kMaxDof, 1).reshaped();
  search.T_task_start = in.pose();
  search.T_task_goal = in.pose();
  for (std::size_t count = in.integer(kMaxBlockers); count > 0; --count) {
    auto [first, second] = read_names(in);
    search.blockers.push_back({std::move(first), std::move(second), in.integer()});
  }
  for (std::size_t count = in.integer(kMaxGoalContacts); count > 0; --count) {
    const auto goal = static_cast<std::uint32_t>(in.integer(kMaxSearchGoals));
    auto [first, second] = read_names(in);
    search.goal_contacts.push_back({goal, std::move(first), std::move(second)});
  }
  for (std::size_t count = in.integer(kMaxAllowedPairs); count > 0; --count)
    search.allowed_collisions.push_back(read_names(in));
  search.seed = in.integer();
  search.reason = in.text(kMaxMessageBytes);
  for (std::size_t count = in.integer(kMaxSearchTrees); count > 0; --count)
    search.trees.push_back(read_tree(in));
  if (!in.at_end())
    throw std::out_of_range("search: bytes after its end");
  return search;
}

}  // namespace

std::vector<std::uint8_t> encode_search(const SearchRecord& search) {
  ByteWriter out;
  out.add(kSearchFormat).add(Eigen::MatrixXd(search.start)).add(search.goals);
  out.add(Eigen::MatrixXd(search.last_free)).add(search.T_task_start).add(search.T_task_goal);
  out.add(std::uint64_t{search.blockers.size()});
  for (const Blocker& blocker : search.blockers)
    out.add(blocker.first).add(blocker.second).add(blocker.count);
  out.add(std::uint64_t{search.goal_contacts.size()});
  for (const GoalContact& contact : search.goal_contacts)
    out.add(std::uint64_t{contact.goal}).add(contact.first).add(contact.second);
  out.add(std::uint64_t{search.allowed_collisions.size()});
  for (const auto& [first, second] : search.allowed_collisions)
    out.add(first).add(second);
  out.add(search.seed).add(search.reason);
  out.add(std::uint64_t{search.trees.size()});
  for (const SearchTree& tree : search.trees)
    add(out, tree);
  ByteWriter blob;
  blob.add(std::uint64_t{out.bytes().size()});
  return blob.add(Bytes(compress(out.bytes()).value_or(out.bytes()))).bytes();
}

std::optional<SearchRecord> decode_search(Bytes bytes) {
  std::uint64_t size = 0;
  if (bytes.size() < sizeof size)
    return std::nullopt;
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes = bytes.subspan(sizeof size);
  std::optional<std::vector<std::uint8_t>> plain;
  if (size > kMaxPlainSearch)
    return std::nullopt;
  if (bytes.size() != size) {  // else it was not smaller compressed
    plain = decompress(bytes, size);
    if (!plain)
      return std::nullopt;
    bytes = *plain;
  }
  try {
    ByteReader in(bytes);
    SearchRecord search = read_search(in);
    if (check_search(search))
      return std::nullopt;
    return search;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

}  // namespace kinship::store
