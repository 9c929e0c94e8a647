#pragma once

#include <cstdint>

#include "proto/types/conversations.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/uuid.hpp"

/// The four conversations as types: request, reply, and the refusal of a request that cannot be
/// served. And the two publications, which are sent without a request.
namespace kinship::codec {

/// Identifies the request of a reply; the first members of every message.
struct Head {
  Uuid client_id;
  std::uint64_t sequence_number = 0;

  auto operator<=>(const Head&) const = default;
};

struct RegisterConversation {
  using Request = RobotDescription;
  using Reply = RegisterReply;
  static constexpr const char* kName = "register";
  static Reply refuse(const Error& error);
};

struct ReportConversation {
  using Request = ReportRequest;
  using Reply = ReportReply;
  static constexpr const char* kName = "report";
  /// No receipts: the client tries again.
  static Reply refuse(const Error& error);
};

struct FetchConversation {
  using Request = FetchRequest;
  using Reply = FetchReply;
  static constexpr const char* kName = "fetch";
  static Reply refuse(const Error& error);
};

struct AdminConversation {
  using Request = AdminRequest;
  using Reply = AdminReply;
  static constexpr const char* kName = "admin";
  static Reply refuse(const Error& error);
};

struct AnnouncementPublication {
  using Value = Announcement;
  static constexpr const char* kName = "announcement";
};

struct EventPublication {
  using Value = Event;
  static constexpr const char* kName = "event";
};

}  // namespace kinship::codec
