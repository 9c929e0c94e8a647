#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/uuid.hpp"

/// Values that the server publishes without a request.
namespace kinship {

/// Announces a newer revision of a followed distribution, to be fetched.
struct Announcement {
  Digest distribution_id;
  std::string task;
  Digest robot;
  std::uint64_t revision = 0;
  Uuid store_epoch;
};

template <>
inline constexpr std::tuple kFieldsOf<Announcement>{
    Field{"distribution_id", &Announcement::distribution_id},
    Field{"revision", &Announcement::revision}, Field{"store_epoch", &Announcement::store_epoch},
    Field{"robot", &Announcement::robot},
    Field{"task", &Announcement::task, {.check = check_task}}};

enum class EventKind { Registered, Report, Fetch, Fit, Refusal, Administration };

/// An event of the server, for people who watch.
struct Event {
  EventKind kind = EventKind::Report;
  std::int64_t time_ms = 0;  ///< Unix time, UTC
  std::string task;          ///< may be empty
  std::string robot;         ///< label or short digest; may be empty
  std::string text;          ///< description, one line, at most kMaxEventBytes
};

template <>
inline constexpr std::tuple kFieldsOf<Event>{
    Field{"kind", &Event::kind, {.max = static_cast<double>(EventKind::Administration)}},
    Field{"time_ms", &Event::time_ms}, Field{"task", &Event::task, {.limit = kMaxTaskBytes}},
    Field{"robot", &Event::robot, {.limit = kMaxLabelBytes}},
    Field{"text", &Event::text, {.limit = kMaxEventBytes}}};

}  // namespace kinship
