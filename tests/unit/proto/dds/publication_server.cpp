// A server for tests that publishes what it is told: publication_server DOMAIN. Prints "ready" when
// it serves. Arguments of admin requests are its commands; the answer follows the publication.
//   announce N REVISION   the distribution whose id is N in every byte
//   withdraw N
//   event TEXT
//   flood COUNT           as many announcements, of ids of their own, and events; answers with the
//                         milliseconds of the slowest

#include <algorithm>
#include <chrono>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string>

#include "proto/dds/publication.hpp"
#include "proto/dds/replier.hpp"
#include "proto/types/limits.hpp"

namespace kinship {
namespace {

class Server {
 public:
  explicit Server(std::uint32_t domain)
      : participant_({.domain = domain, .role = dds::Role::Server}),
        announcements_(participant_),
        events_(participant_),
        loop_(participant_),
        admin_(participant_, loop_,
               [this](const AdminRequest& request,
                      const dds::Answer<codec::AdminConversation>& answer) {
                 AdminReply reply;
                 reply.status = AdminStatus::Ok;
                 reply.rows = {obey(request.argument)};
                 answer(reply);
               }) {}

  void run() {
    loop_.run([] { return dds::WaitLoop::Clock::time_point::max(); });
  }

 private:
  std::string obey(const std::string& command) {
    std::istringstream words(command);
    std::string verb;
    unsigned number = 0;
    std::uint64_t revision = 0;
    words >> verb;
    if (verb == "event") {
      std::getline(words >> std::ws, event_.text);
      events_.publish(event_);
      return "done";
    }
    words >> number >> revision;
    if (verb == "flood")
      return std::to_string(flood(number));
    Announcement announcement{.distribution_id = {},
                              .task = "bin_to_shelf",
                              .robot = {},
                              .revision = revision,
                              .store_epoch = {}};
    announcement.distribution_id.bytes.fill(static_cast<std::uint8_t>(number));
    if (verb == "announce")
      announcements_.publish(announcement);
    else
      announcements_.withdraw(announcement.distribution_id);
    return "done";
  }

  std::int64_t flood(unsigned count) {
    using Clock = std::chrono::steady_clock;
    Announcement announcement;
    announcement.task = "bin_to_shelf";
    event_.text = std::string(kMaxEventBytes, 'x');
    Clock::duration slowest{0};
    for (unsigned i = 0; i < count; ++i) {
      std::memcpy(announcement.distribution_id.bytes.data(), &i, sizeof i);
      const Clock::time_point start = Clock::now();
      announcements_.publish(announcement);
      events_.publish(event_);
      slowest = std::max(slowest, Clock::now() - start);
    }
    return std::chrono::duration_cast<std::chrono::milliseconds>(slowest).count();
  }

  dds::Participant participant_;
  dds::Publisher<codec::AnnouncementPublication> announcements_;
  dds::Publisher<codec::EventPublication> events_;
  dds::WaitLoop loop_;
  dds::Replier<codec::AdminConversation> admin_;
  Event event_;
};

}  // namespace
}  // namespace kinship

int main(int /*argc*/, char** argv) {
  kinship::Server server(static_cast<std::uint32_t>(std::stoul(argv[1])));
  std::cout << "ready" << std::endl;
  server.run();
}
