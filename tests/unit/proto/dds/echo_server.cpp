// A server for tests: echo_server DOMAIN [FOLDER]. Prints "ready" when it serves, or "error: ..."
// and ends with 1. Admin requests are answered with their argument, "who" with who asks, "log" with
// all others so far, NAME:ARGUMENT; ListPaths with one row of `limit` KB. FOLDER: with the security
// that `kinshipd secure init` made there.

#include <iostream>
#include <string>

#include "proto/dds/replier.hpp"
#include "proto/security/access_role.hpp"
#include "tests/unit/proto/dds/secured_server.hpp"

namespace {

using namespace kinship;

std::string who(const Caller& caller) {
  return caller.client + '|' + caller.name + '|' + security::role_name(caller.role) + '|' +
         (caller.tasks.empty() ? "" : caller.tasks.front()) + '|' +
         (caller.is_local ? "local" : "remote");
}

std::string answer_to(const AdminRequest& request, const Caller& caller, const std::string& log) {
  if (request.verb == AdminVerb::ListPaths)
    return std::string(std::size_t{1000} * request.limit, 'x');
  if (request.argument == "who")
    return who(caller);
  return request.argument == "log" ? log : request.argument;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const dds::Participant participant(test::server_options(argc, argv));
    dds::WaitLoop loop(participant);
    const dds::Replier<codec::AdminConversation> admin(
        participant, loop,
        [log = std::string()](const AdminRequest& request,
                              const dds::Answer<codec::AdminConversation>& answer) mutable {
          AdminReply reply;
          reply.status = AdminStatus::Ok;
          if (request.argument != "log")
            log += answer.caller().name + ':' + request.argument + ' ';
          reply.rows = {answer_to(request, answer.caller(), log)};
          answer(reply);
        });
    std::cout << "ready" << std::endl;
    loop.run([] { return dds::WaitLoop::Clock::time_point::max(); });
  } catch (const Failure& failure) {
    std::cout << "error: " << failure.what() << std::endl;
    return 1;
  }
}
