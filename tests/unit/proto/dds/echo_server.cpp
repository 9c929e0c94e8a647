// A server for tests: echo_server DOMAIN. Prints "ready" when it serves, or "error: ..." and ends
// with 1. Admin requests are answered with their argument; ListPaths with one row of `limit` KB.

#include <iostream>
#include <string>

#include "proto/dds/replier.hpp"

int main(int /*argc*/, char** argv) {
  using namespace kinship;
  try {
    const dds::Participant participant(
        {.domain = static_cast<std::uint32_t>(std::stoul(argv[1])), .role = dds::Role::Server});
    dds::WaitLoop loop(participant);
    const dds::Replier<codec::AdminConversation> admin(
        participant, loop,
        [](const AdminRequest& request, const dds::Answer<codec::AdminConversation>& answer) {
          AdminReply reply;
          reply.status = AdminStatus::Ok;
          reply.rows = {request.verb == AdminVerb::ListPaths
                            ? std::string(std::size_t{1000} * request.limit, 'x')
                            : request.argument};
          answer(reply);
        });
    std::cout << "ready" << std::endl;
    loop.run([] { return dds::WaitLoop::Clock::time_point::max(); });
  } catch (const Failure& failure) {
    std::cout << "error: " << failure.what() << std::endl;
    return 1;
  }
}
