// Somebody who does not keep to the rules, with Cyclone DDS that was changed to let him:
//
//   intruder write DOMAIN FOLDER PARTITION WAY TEXT          sends admin requests with an argument
//   intruder reset DOMAIN FOLDER PARTITION WAY TASK          ... that reset a task
//   intruder register DOMAIN FOLDER PARTITION WAY LABEL      sends the registration of a robot
//   intruder report DOMAIN FOLDER PARTITION WAY TASK ROBOT   sends a report; ROBOT: its digest
//   intruder read DOMAIN FOLDER PARTITION WAY                reads admin replies
//   intruder serve DOMAIN FOLDER PARTITION WAY               reads admin requests, at the server's
//   port intruder tell DOMAIN FOLDER PARTITION WAY TEXT           sends admin replies, from there
//
// FOLDER: credentials, or "-" for none; PARTITION: "-" for the default one. WAY: honest; changed,
// with a plugin that allows whatever this process makes; hidden, which also hides the security
// attributes of its readers and writers; earlier, honest by a clock that is a day behind. Prints
// "joined" or "refused: WHY", and then "heard TEXT" for each message that reaches it. It does not
// have the guard of Participant: with the server's credentials it is a server without guard.

#include <dds/dds.h>
#include <dds/ddsi/ddsi_plist.h>
#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <optional>
#include <string>
#include <thread>

#include "proto/dds/loan.hpp"
#include "proto/dds/log.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/wire.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

namespace {

using namespace kinship;
using namespace std::chrono_literals;

bool hides_attributes = false;
time_t behind_s = 0;  // of this process's clock

/// What this process says of a reader or writer of its own.
ddsi_plist_t told(const ddsi_plist_t& plist) {
  ddsi_plist_t told = plist;
  if (hides_attributes)
    told.endpoint_security_info = {};
  return told;
}

struct Wish {
  std::string verb;
  std::uint32_t domain = 0;
  std::string folder;
  std::string partition;
  std::string way;
  std::string text;
  std::string robot;
};

bool is_server(const Wish& wish) { return wish.verb == "serve" || wish.verb == "tell"; }

dds::Entity join(const Wish& wish) {
  const dds::ParticipantOptions options{
      .domain = wish.domain, .role = is_server(wish) ? dds::Role::Server : dds::Role::Client};
  dds::require(dds_create_domain(wish.domain, dds::cyclone_configuration(options).c_str()),
               "domain");
  dds::Qos qos;
  if (wish.folder != "-") {
    qos = dds::security_qos(wish.folder);
    char* plugin = nullptr;
    const bool is_changed = wish.way == "changed" || wish.way == "hidden";
    if (is_changed && dds_qget_prop(qos.get(), "dds.sec.access.library.path", &plugin)) {
      setenv("KINSHIP_ACCESS_CONTROL", plugin, 1);
      dds_free(plugin);
      dds_qset_prop(qos.get(), "dds.sec.access.library.path", KINSHIP_PERMISSIVE_PLUGIN);
    }
  }
  return {dds_create_participant(wish.domain, qos.get(), nullptr), "participant"};
}

dds::Qos partition(const Wish& wish) {
  return wish.partition == "-" ? dds::Qos() : dds::partition_qos(wish.partition);
}

/// Sends every 200 ms: what is not matched yet is lost.
/// \param next  makes the next message.
template <typename Next>
[[noreturn]] void send(const Wish& wish, const dds::Entity& participant,
                       const dds_topic_descriptor_t& type, const std::string& name,
                       const Next& next) {
  const dds::Entity topic(
      dds_create_topic(participant.get(), &type, name.c_str(), nullptr, nullptr), "topic");
  const dds::Entity publisher(
      dds_create_publisher(participant.get(), partition(wish).get(), nullptr), "publisher");
  const dds::Qos qos = is_server(wish) ? dds::reply_qos() : dds::request_qos();
  const dds::Entity writer(dds_create_writer(publisher.get(), topic.get(), qos.get(), nullptr),
                           "writer");
  std::cout << "joined" << std::endl;
  while (true) {
    const auto message = next();
    dds_write(writer.get(), &message.wire);
    std::this_thread::sleep_for(200ms);  // as long as the test lets it
  }
}

template <typename Conversation>
[[noreturn]] void ask(const Wish& wish, const dds::Entity& participant,
                      const typename Conversation::Request& request) {
  const dds::Topics topics = dds::Wire<Conversation>::topics();
  codec::Head head{.client_id = Uuid::random()};
  send(wish, participant, topics.request, topics.request_topic(), [&] {
    ++head.sequence_number;
    return codec::encode(head, request).value_or_throw();
  });
}

[[noreturn]] void tell(const Wish& wish, const dds::Entity& participant) {
  AdminReply reply;
  reply.rows = {wish.text};
  const dds::Topics topics = dds::Wire<codec::AdminConversation>::topics();
  send(wish, participant, topics.reply, topics.reply_topic(),
       [&] { return codec::encode(codec::Head{}, reply).value_or_throw(); });
}

/// What is sent by a verb that asks.
[[noreturn]] void ask(const Wish& wish, const dds::Entity& participant) {
  if (wish.verb == "register") {
    RobotDescription robot = test::model_description("ur10e");
    robot.label = wish.text;
    ask<codec::RegisterConversation>(wish, participant, robot);
  }
  if (wish.verb == "report") {
    ReportRequest request;
    request.attempts = {
        test::panda_attempt(Digest::from_hex(wish.robot).value(), wish.text, /*seed=*/1)};
    ask<codec::ReportConversation>(wish, participant, request);
  }
  AdminRequest request;
  request.verb = wish.verb == "reset" ? AdminVerb::ResetTask : AdminVerb::Status;
  request.argument = wish.text;
  ask<codec::AdminConversation>(wish, participant, request);
}

template <typename Message, typename TextOf>
[[noreturn]] void read(const Wish& wish, const dds::Entity& participant,
                       const dds_topic_descriptor_t& type, const std::string& name,
                       const TextOf& text_of) {
  const dds::Entity topic(
      dds_create_topic(participant.get(), &type, name.c_str(), nullptr, nullptr), "topic");
  const dds::Entity subscriber(
      dds_create_subscriber(participant.get(), partition(wish).get(), nullptr), "subscriber");
  const dds::Entity reader(
      dds_create_reader(subscriber.get(), topic.get(), dds::reply_qos().get(), nullptr), "reader");
  // A client waits for who can answer it, too.
  const dds::Topics topics = dds::Wire<codec::AdminConversation>::topics();
  const dds::Entity reply_topic(dds_create_topic(participant.get(), &topics.reply,
                                                 topics.reply_topic().c_str(), nullptr, nullptr),
                                "topic");
  const dds::Entity publisher(
      dds_create_publisher(participant.get(), partition(wish).get(), nullptr), "publisher");
  std::optional<dds::Entity> writer;
  if (wish.verb == "serve")
    writer.emplace(
        dds_create_writer(publisher.get(), reply_topic.get(), dds::reply_qos().get(), nullptr),
        "writer");
  std::cout << "joined" << std::endl;
  while (true) {
    {
      const dds::Loan loan(reader, "messages");
      for (std::size_t i = 0; i < loan.size(); ++i)
        if (loan[i])
          std::cout << "heard " << text_of(*static_cast<const Message*>(loan[i])) << std::endl;
    }
    std::this_thread::sleep_for(20ms);
  }
}

[[noreturn]] void run(const Wish& wish) {
  const dds::Entity participant = join(wish);
  const dds::Topics topics = dds::Wire<codec::AdminConversation>::topics();
  if (wish.verb == "tell")
    tell(wish, participant);
  if (wish.verb == "serve")
    read<kinship_wire_AdminRequest>(
        wish, participant, topics.request, topics.request_topic(),
        [](const kinship_wire_AdminRequest& request) { return std::string(request.argument); });
  if (wish.verb == "read")
    read<kinship_wire_AdminReply>(
        wish, participant, topics.reply, topics.reply_topic(),
        [](const kinship_wire_AdminReply& reply) {
          return std::string(reply.rows._length > 0 ? reply.rows._buffer[0] : reply.message);
        });
  ask(wish, participant);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void ddsi_plist_addtomsg(
    nn_xmsg* message, const ddsi_plist_t* plist, std::uint64_t plist_wanted,
    std::uint64_t qos_wanted) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsi_plist_addtomsg)>(
      dlsym(RTLD_NEXT, "ddsi_plist_addtomsg"));  // NOLINT: what dlsym is for
  const ddsi_plist_t said = told(*plist);
  kBehind(message, &said, plist_wanted, qos_wanted);
}

/// In front of the C library's, which OpenSSL and Cyclone DDS ask for the date.
extern "C" __attribute__((visibility("default"))) int clock_gettime(clockid_t clock,
                                                                    timespec* time) {
  const auto result = static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  if (result == 0 && clock == CLOCK_REALTIME)
    time->tv_sec -= behind_s;
  return result;
}

extern "C" __attribute__((visibility("default"))) time_t time(time_t* into) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (into != nullptr)
    *into = now.tv_sec;
  return now.tv_sec;
}

int main(int argc, char** argv) {
  if (argc < 6)
    return 2;
  const Wish wish{argv[1],
                  static_cast<std::uint32_t>(std::stoul(argv[2])),
                  argv[3],
                  argv[4],
                  argv[5],
                  argc > 6 ? argv[6] : "",
                  argc > 7 ? argv[7] : ""};
  hides_attributes = wish.way == "hidden";
  if (wish.way == "earlier")
    behind_s = std::chrono::seconds(std::chrono::days(1)).count();
  dds::set_log_sink({});
  dds::limit_log();
  try {
    run(wish);
  } catch (const Failure& failure) {
    std::cout << "refused: " << failure.what() << std::endl;
    return 1;
  }
}
