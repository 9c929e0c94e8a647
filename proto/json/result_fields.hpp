#pragma once

#include <tuple>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/problem.hpp"

/// The tables of a result's document, beside its path; for this library and the maker of its
/// schema.
namespace kinship::json {

inline constexpr std::tuple kEffort{
    Field{"name", &ProblemResult::name, {.limit = kMaxTaskBytes}},
    Field{"solved", &ProblemResult::solved},
    Field{"collision_checks", &ProblemResult::collision_checks},
    Field{"goal_checks", &ProblemResult::goal_checks, {.may_be_missing = true}},
    Field{"shortcut_checks", &ProblemResult::shortcut_checks, {.may_be_missing = true}},
    Field{"projections", &ProblemResult::projections},
    Field{"proven", &ProblemResult::proven, {.may_be_missing = true}},
    Field{"path_length", &ProblemResult::path_length, {.min = 0, .may_be_missing = true}},
    Field{"hand_length_m", &ProblemResult::hand_length_m, {.min = 0, .may_be_missing = true}},
    Field{
        "least_clearance_m", &ProblemResult::least_clearance_m, {.min = 0, .may_be_missing = true}},
    Field{"refuted_edges", &ProblemResult::refuted_edges, {.may_be_missing = true}},
    Field{"planning_time_s", &ProblemResult::planning_time_s, {.min = 0}},
    Field{"processor_time_s", &ProblemResult::processor_time_s, {.min = 0, .may_be_missing = true}},
    Field{"time_limit_s", &ProblemResult::time_limit_s, {.min = 0}}};

/// If there is a distribution, or the query was guided or control.
inline constexpr std::tuple kGuidance{
    Field{"distribution_id", &ProblemResult::distribution_id, {.may_be_missing = true}},
    Field{"revision", &ProblemResult::distribution_revision},
    Field{"share", &ProblemResult::share, {.min = 0, .max = 1}},
    Field{"sampling_mode", &ProblemResult::sampling_mode},
    Field{"gate_fired", &ProblemResult::gate_fired, {.may_be_missing = true}},
    Field{"track_share", &ProblemResult::track_share, {.min = 0, .max = 1, .may_be_missing = true}},
    Field{"experience_revision", &ProblemResult::experience_revision, {.may_be_missing = true}},
    Field{"tracks_followed", &ProblemResult::tracks_followed, {.may_be_missing = true}},
    Field{"recall_tries", &ProblemResult::recall_tries, {.may_be_missing = true}},
    Field{"guide", &ProblemResult::guide, {.may_be_missing = true}}};

inline constexpr std::tuple kReasons{
    Field{"found_by", &ProblemResult::found_by, {.may_be_missing = true}},
    Field{"guidance_reason",
          &ProblemResult::guidance_reason,
          {.limit = kMaxMessageBytes, .may_be_missing = true}},
    Field{"planner", &ProblemResult::planner, {.limit = kMaxPlannerBytes, .may_be_missing = true}},
    Field{"reason", &ProblemResult::reason, {.limit = kMaxMessageBytes, .may_be_missing = true}},
    Field{"not_planned", &ProblemResult::not_planned, {.may_be_missing = true}}};

}  // namespace kinship::json
