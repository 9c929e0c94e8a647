#pragma once

#include <cstdint>
#include <string>

#include "proto/types/digest.hpp"
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

enum class EventKind { Registered, Report, Fetch, Fit, Refusal, Administration };

/// An event of the server, for people who watch.
struct Event {
  EventKind kind = EventKind::Report;
  std::int64_t time_ms = 0;  ///< Unix time, UTC
  std::string task;          ///< may be empty
  std::string robot;         ///< label or short digest; may be empty
  std::string text;          ///< description, one line, at most kMaxEventBytes
};

}  // namespace kinship
