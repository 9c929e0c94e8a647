#include "proto/dds/role_topics.hpp"

#include <algorithm>
#include <vector>

#include "proto/security/access_role.hpp"
#include "proto/security/permissions.hpp"

namespace kinship::dds {
namespace {

Error not_for(const security::Credentials& credentials, const std::string& what) {
  return invalid_input(what + ": not for the role '" + credentials.role +
                       "', which is in the certificate of '" + credentials.name + "'");
}

}  // namespace

std::optional<Error> explain_not_allowed(const Participant& participant,
                                         const std::string& conversation) {
  if (!participant.credentials())
    return std::nullopt;
  const auto role = security::read_role(participant.credentials()->role);
  if (!role)
    return role.error();
  const std::vector<std::string> allowed = security::conversations_of(*role);
  if (std::ranges::find(allowed, conversation) != allowed.end())
    return std::nullopt;
  return not_for(*participant.credentials(), conversation);
}

void require_events(const Participant& participant) {
  if (!participant.credentials())
    return;
  if (security::read_role(participant.credentials()->role).value_or_throw() == AccessRole::Robot)
    throw Failure(not_for(*participant.credentials(), "events"));
}

}  // namespace kinship::dds
