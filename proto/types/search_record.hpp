#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Two bodies that touched, or were too near, in some of the configurations that were refused.
/// Bodies are links, objects and held objects, by name.
struct Blocker {
  std::string first, second;
  std::uint64_t count = 0;  ///< of the configurations that were looked at
};

template <>
inline constexpr std::tuple kFieldsOf<Blocker>{
    Field{"first", &Blocker::first, {.limit = kMaxLinkNameBytes}},
    Field{"second", &Blocker::second, {.limit = kMaxLinkNameBytes}},
    Field{"count", &Blocker::count}};

/// Two bodies that touch, or are too near, at a goal configuration.
struct GoalContact {
  std::uint32_t goal = 0;  ///< column of SearchRecord::goals
  std::string first, second;
};

template <>
inline constexpr std::tuple kFieldsOf<GoalContact>{
    Field{"goal", &GoalContact::goal},
    Field{"first", &GoalContact::first, {.limit = kMaxLinkNameBytes}},
    Field{"second", &GoalContact::second, {.limit = kMaxLinkNameBytes}}};

/// A tree of a search, from the start or from the goals.
struct SearchTree {
  Eigen::MatrixXf configurations;     ///< dof x n, in the order of insertion, joint units
  std::vector<std::int32_t> parents;  ///< n: an earlier configuration of the tree, or -1
};

/// What explains an attempt, and lets it be planned again: its query besides the scene, and what
/// was in the way. Everything may be missing.
struct SearchRecord {
  Eigen::VectorXd start;                          ///< dof, joint units; empty: none was found
  Eigen::MatrixXd goals;                          ///< dof x n, joint units; also those that touch
  std::optional<Eigen::Isometry3d> T_task_start;  ///< of the transfer frame, if asked so
  std::optional<Eigen::Isometry3d> T_task_goal;   ///< of the transfer frame, if asked so
  std::vector<Blocker> blockers;                  ///< the most frequent first
  std::vector<GoalContact> goal_contacts;
  Eigen::VectorXd last_free;  ///< dof; nearest to a goal of what the search reached; or empty
  std::vector<SearchTree> trees;
  /// Pairs of a link and an object, or what is held, that may touch; the scene has the others.
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
  std::uint64_t seed = 0;  ///< of the query
  std::string reason;      ///< why not solved
};

/// Joints of the configurations of a record; 0 if it has none.
Eigen::Index dof_of(const SearchRecord& search);

/// Bytes of a record that count against kMaxSearchBytes, and with waypoints against kMaxBatchBytes:
/// 128, 8 for each number of a configuration and 56 for each pose, 24 and the names of each pair of
/// bodies, 4 for each number and parent of a tree, and those of the reason.
std::size_t search_bytes(const SearchRecord& search);

/// The rule of the contract that a record breaks, if any: equal joints, finite numbers, names of 1
/// to kMaxLinkNameBytes of text, parents before their children, counts and bytes. The message
/// begins with "search".
std::optional<Error> check_search(const SearchRecord& search);

/// A pair of bodies in the way, and the goals at which it touches.
struct GoalBlocker {
  Blocker blocker;        ///< count 0: at goals alone
  std::size_t goals = 0;  ///< of the record's
};

/// The pairs in the way, also those that touch at goals alone: those that block the most goals
/// first, then the most frequent.
std::vector<GoalBlocker> blockers_by_goals(const SearchRecord& search);

/// Why a query was not solved, in words of at most kMaxWhyBytes: the reason; of a search that was
/// begun the bodies in the way, and how near to a goal it came. Empty if the record says nothing.
std::string why_text(const SearchRecord& search);

}  // namespace kinship
