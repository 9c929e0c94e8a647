#include "server/app/endpoints.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "proto/codec/conversation.hpp"
#include "proto/dds/replier.hpp"
#include "server/app/access_gate.hpp"
#include "server/app/admin_reply.hpp"
#include "server/quotas/quota.hpp"

namespace kinship::app {
namespace {

using codec::AdminConversation;
using codec::FetchConversation;
using codec::RegisterConversation;
using codec::ReportConversation;

/// Begins with the name that quotas count (catalog::client_of), which several clients may share.
template <typename Conversation>
std::string request_key_of(const dds::Answer<Conversation>& answer) {
  return answer.caller().client + ' ' + answer.head().client_id.text() + ' ' +
         std::to_string(answer.head().sequence_number);
}

/// The same words for each conversation, in the place that its reply has for them.
template <typename Reply>
std::optional<Reply> reply_to(const std::optional<quotas::Refusal>& refusal, Reply reply) {
  if (!refusal)
    return std::nullopt;
  reply.message = refusal->message;
  reply.retry_after = refusal->retry_after;
  return reply;
}

template <typename Reply>
Reply with_status(Reply reply, decltype(Reply::status) status) {
  reply.status = status;
  return reply;
}

/// A client beyond its quota is refused before its request is read.
template <typename Reply>
auto gate_of(service::Service& service, const Reply& busy) {
  return [&service, busy](const Caller& caller, const codec::RequestSize& size) {
    service.describe_client(caller);
    return reply_to(service.admit(caller.client, size.bytes, size.attempts), busy);
  };
}

/// Answers with the part of the service's answer that begins at a place. Rows of one page can
/// exceed the limit of a message: a listing is then asked for with fewer, a single row cut.
void administer(service::AdminService& service, const AdminRequest& request, const RowCursor& begin,
                const Caller& caller, const dds::Answer<AdminConversation>& answer) {
  service.administer(
      request, request_key_of(answer),
      [=, &service](const service::AdminPage& page) {
        AdminReply reply = to_reply(page);
        if (!fits_page(reply))
          if (const auto smaller = for_fewer_rows(request, page.rows.size()))
            return administer(service, *smaller, begin, caller, answer);
        answer(page_of(std::move(reply), begin));
      },
      caller);
}

/// \param token  null: none is needed.
void administer(service::AdminService& service, security::AdminTokenCheck* token,
                const AdminRequest& request, const dds::Answer<AdminConversation>& answer) {
  const RowCursor begin = read_row_cursor(request.cursor).value_or_throw();
  Caller caller = answer.caller();
  if (token != nullptr && rule_of(request.verb).is(VerbRule::Changes))
    caller.token = token->check(request, answer.head().client_id, request_key_of(answer),
                                security::AdminTokenCheck::TimePoint::clock::now());
  administer(service, for_rest(request, begin), begin, caller, answer);
}

}  // namespace

class Endpoints::Implementation {
 public:
  Implementation(const dds::Participant& participant, dds::WaitLoop& loop,
                 service::Service& service, security::AdminTokenCheck* token)
      : register_(
            participant, loop,
            [&service](RobotDescription description,
                       const dds::Answer<RegisterConversation>& answer) {
              app::register_robot(service.registration(), answer.caller(), std::move(description),
                                  answer);
            },
            [&service](const Caller& caller, const codec::RequestSize& size) {
              service.describe_client(caller);
              return reply_to(service.admit_robot(caller.client, size.bytes), RegisterReply{});
            }),
        report_(
            participant, loop,
            [&service](ReportRequest request, const dds::Answer<ReportConversation>& answer) {
              app::report(service.reports(), service.registration(), answer.caller(),
                          std::move(request), answer);
            },
            gate_of(service, ReportReply{})),
        fetch_(
            participant, loop,
            [&service](const FetchRequest& request, const dds::Answer<FetchConversation>& answer) {
              app::fetch(service.fetches(), service.registration(), answer.caller(), request,
                         request_key_of(answer), answer);
            },
            gate_of(service, with_status(FetchReply(), FetchStatus::Busy))),
        admin_(
            participant, loop,
            [&service, token](const AdminRequest& request,
                              const dds::Answer<AdminConversation>& answer) {
              administer(service.administration(), token, request, answer);
            },
            gate_of(service, with_status(AdminReply(), AdminStatus::Failed))) {}

  /// A client joins the conversations that it needs.
  std::size_t clients() const {
    return std::max({register_.clients(), report_.clients(), fetch_.clients(), admin_.clients()});
  }

 private:
  dds::Replier<RegisterConversation> register_;
  dds::Replier<ReportConversation> report_;
  dds::Replier<FetchConversation> fetch_;
  dds::Replier<AdminConversation> admin_;
};

Endpoints::Endpoints(const dds::Participant& participant, dds::WaitLoop& loop,
                     service::Service& service, security::AdminTokenCheck* token)
    : implementation_(std::make_unique<Implementation>(participant, loop, service, token)) {}

Endpoints::~Endpoints() = default;

std::size_t Endpoints::clients() const { return implementation_->clients(); }

}  // namespace kinship::app
