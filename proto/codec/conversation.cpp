#include "proto/codec/conversation.hpp"

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {
namespace {

/// So that a refusal can always be sent.
std::string message_of(const Error& error) { return cut_text(error.message, kMaxMessageBytes); }

}  // namespace

RegisterReply RegisterConversation::refuse(const Error& error) {
  RegisterReply reply;
  reply.status = RegisterStatus::Refused;
  reply.message = message_of(error);
  return reply;
}

ReportReply ReportConversation::refuse(const Error& /*error*/) { return {}; }

FetchReply FetchConversation::refuse(const Error& error) {
  FetchReply reply;
  reply.status = FetchStatus::Refused;
  reply.message = message_of(error);
  return reply;
}

AdminReply AdminConversation::refuse(const Error& error) {
  const bool is_callers_fault = error.code == ErrorCode::InvalidInput ||
                                error.code == ErrorCode::TooLarge ||
                                error.code == ErrorCode::Conflict;
  AdminReply reply;
  reply.status = error.code == ErrorCode::NotFound ? AdminStatus::NotFound
                 : is_callers_fault                ? AdminStatus::Refused
                                                   : AdminStatus::Failed;
  reply.message = message_of(error);
  return reply;
}

}  // namespace kinship::codec
