// A server for tests that publishes what it is told: publication_server DOMAIN [FOLDER]. Prints
// "ready" when it serves. Arguments of admin requests are its commands; the answer follows the
// publication. FOLDER: with the security that `kinshipd secure init` made there; then a client
// hears of tasks that it is narrowed to, and distribution 9 is announced from the start.
//   announce N REVISION [TASK]   the distribution whose id is N in every byte
//   overtake N REVISION   the same; when somebody is told of it, its next revision is published at
//                         once, by another thread, and has been before that goes on
//   withdraw N
//   event TEXT   unless it is the one before: then this is a resend
//   flood COUNT           as many announcements, of ids of their own, and events; answers with the
//                         number of times that took 90 ms or more
//   churn COUNT           announces and withdraws as many distributions

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "proto/dds/publication.hpp"
#include "proto/dds/replier.hpp"
#include "proto/types/limits.hpp"
#include "tests/unit/proto/dds/secured_server.hpp"

namespace kinship {
namespace {

class Server {
 public:
  explicit Server(const dds::ParticipantOptions& options)
      : participant_(options),
        loop_(participant_),
        announcements_(participant_, loop_,
                       [this](const Caller& caller, const Announcement& announcement) {
                         return may_hear(caller, announcement);
                       }),
        events_(participant_, loop_),
        admin_(participant_, loop_,
               [this](const AdminRequest& request,
                      const dds::Answer<codec::AdminConversation>& answer) {
                 AdminReply reply;
                 reply.status = AdminStatus::Ok;
                 reply.rows = {obey(request.argument)};
                 answer(reply);
               }) {
    if (participant_.credentials())
      obey("announce 9 1");
  }

  void run() {
    loop_.run([] { return dds::WaitLoop::Clock::time_point::max(); });
  }

 private:
  bool may_hear(const Caller& caller, const Announcement& announcement) {
    std::uint64_t told = announcement.revision;
    if (told > 0 && overtaken_.compare_exchange_strong(told, 0))
      std::thread([&] {
        Announcement next = announcement;
        ++next.revision;
        announcements_.publish(next);
      }).join();
    return caller.tasks.empty() ||
           std::ranges::find(caller.tasks, announcement.task) != caller.tasks.end();
  }

  std::string obey(const std::string& command) {
    std::istringstream words(command);
    std::string verb;
    unsigned number = 0;
    std::uint64_t revision = 0;
    words >> verb;
    if (verb == "event") {
      std::string text;
      std::getline(words >> std::ws, text);
      if (std::exchange(event_.text, text) != text)
        events_.publish(event_);
      return "done";
    }
    words >> number >> revision;
    if (verb == "flood" || verb == "churn") {
      if (command != last_long_command_) {  // a resend of it has waited behind the first copy
        last_long_command_ = command;
        last_answer_ = verb == "flood" ? std::to_string(flood(number)) : churn(number);
      }
      return last_answer_;
    }
    Announcement announcement{.distribution_id = {},
                              .task = "bin_to_shelf",
                              .robot = {},
                              .revision = revision,
                              .store_epoch = {}};
    announcement.distribution_id.bytes.fill(static_cast<std::uint8_t>(number));
    if (std::string task; words >> task)
      announcement.task = task;
    if (verb == "overtake")
      overtaken_ = revision;
    if (verb != "withdraw")
      announcements_.publish(announcement);
    else
      announcements_.withdraw(announcement.distribution_id);
    return "done";
  }

  static Announcement numbered(unsigned number) {
    Announcement announcement;
    announcement.task = "bin_to_shelf";
    std::memcpy(announcement.distribution_id.bytes.data(), &number, sizeof number);
    announcement.distribution_id.bytes.back() = 1;
    return announcement;
  }

  int flood(unsigned count) {
    using Clock = std::chrono::steady_clock;
    event_.text = std::string(kMaxEventBytes, 'x');  // 16 000 are more than a writer keeps
    int slow = 0;
    for (unsigned i = 0; i < count; ++i) {
      const Clock::time_point start = Clock::now();
      announcements_.publish(numbered(i << 8U));
      events_.publish(event_);
      if (Clock::now() - start >= std::chrono::milliseconds(90))
        ++slow;
    }
    return slow;
  }

  std::string churn(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const Announcement announcement = numbered(++churned_ << 8U);
      announcements_.publish(announcement);
      announcements_.withdraw(announcement.distribution_id);
    }
    return "done";
  }

  std::atomic<std::uint64_t> overtaken_ = 0;  // revision; 0: none
  dds::Participant participant_;
  dds::WaitLoop loop_;
  dds::Publisher<codec::AnnouncementPublication> announcements_;
  dds::Publisher<codec::EventPublication> events_;
  dds::Replier<codec::AdminConversation> admin_;
  Event event_;
  unsigned churned_ = 0;
  std::string last_long_command_, last_answer_;
};

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  kinship::Server server(kinship::test::server_options(argc, argv));
  std::cout << "ready" << std::endl;
  server.run();
}
