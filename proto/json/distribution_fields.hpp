#pragma once

#include <tuple>

#include "proto/types/advice.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

/// The tables of a distribution's document, beside its mixture; for this library and the maker of
/// its schema.
namespace kinship::json {

/// A distribution's identity and origin.
inline constexpr std::tuple kProvenance{
    Field{"id", &Distribution::id},
    Field{"revision", &Distribution::revision},
    Field{"store_epoch", &Distribution::store_epoch},
    Field{"task", &Distribution::task, {.limit = kMaxTaskBytes}},
    Field{"robot", &Distribution::robot},
    Field{"T_task_base", &Distribution::T_task_base},
    Field{"profile", &Distribution::profile, {.limit = kMaxProfileBytes}},
    Field{"selection", &Distribution::selection},
    Field{"engines", &Distribution::engines, {.limit = kMaxMessageBytes}},
    Field{"sources", &Distribution::sources, {.limit = kMaxSources}},
    Field{"configurations", &Distribution::configurations}};

inline constexpr std::tuple kAdvice{
    Field{"recommended_share", &Advice::recommended_share, {.min = 0, .max = 1}},
    Field{"guided_share", &Advice::guided_share, {.min = 0, .max = 1}},
    Field{"evidence", &Advice::evidence, {.limit = kMaxMessageBytes}},
    Field{"guided", &Advice::guided},
    Field{"control", &Advice::control},
    Field{"recent", &Advice::recent, {.limit = kMaxJudgedAttempts}}};

/// How its fit went.
inline constexpr std::tuple kFit{
    Field{"state", &Distribution::state},
    Field{"reason", &Distribution::reason, {.limit = kMaxMessageBytes}},
    Field{"fitted_ms", &Distribution::fitted_ms},
    Field{"transfer_time_s", &Distribution::transfer_time_s, {.min = 0}},
    Field{"fit_time_s", &Distribution::fit_time_s, {.min = 0}},
    Field{"fit", &Distribution::fit}};

}  // namespace kinship::json
