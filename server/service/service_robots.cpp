// Of the service: robots that register. One in memory waits for no request that needs the store.

#include <memory>
#include <string>
#include <utility>

#include "server/service/publish_events.hpp"
#include "server/service/service.hpp"

namespace kinship::service {
namespace {

using runtime::Trouble;
using Priority = runtime::WorkerPool::Priority;

}  // namespace

/// Of a robot. Shared by the threads that answer it, one after the other.
struct Service::Registration {
  RobotDescription description;
  std::function<void(const RegisterReply&)> done;
  std::string client;
  runtime::RobotRegistry::LabelRule may_take;
};

void Service::register_robot(RobotDescription description,
                             std::function<void(const RegisterReply&)> done,
                             const std::string& client,
                             runtime::RobotRegistry::LabelRule may_take) {
  const auto registration = std::make_shared<const Registration>(
      Registration{std::move(description), std::move(done), client, std::move(may_take)});
  begin(memory_task_pool_, registration, [this, registration] {
    const Registration& asked = *registration;
    const auto robot = std::make_shared<const runtime::Candidate>(asked.description);
    if (const auto known = robots_.register_known(*robot, asked.may_take))
      return announce_registered(asked, *known);
    begin(short_task_pool_, registration, [this, registration, robot] {
      announce_registered(*registration, robots_.register_robot(*robot, options_.clock.unix_ms(),
                                                                registration->may_take));
    });
  });
}

/// \param answer  may throw Failure(Storage), std::bad_alloc: a refusal would be final.
void Service::begin(runtime::WorkerPool& pool, const RegistrationPointer& registration,
                    std::function<void()> answer) {
  const std::string& client = registration->client;
  auto run = [this, registration, answer = std::move(answer)] {
    try {
      answer();
    } catch (const std::exception& exception) {  // a fault of ours, which may pass: it asks again
      troubles_.add(Trouble::RobotUnanswered,
                    "'" + registration->description.label + "': " + exception.what());
    }
  };
  if (pool.submit(Priority::Interactive, {.run = std::move(run), .abandon = {}, .client = client}))
    return;
  troubles_.add(Trouble::RobotUnanswered, "busy or stopping");
  if (stop_source_.stop_requested())
    return;  // another server may come
  RegisterReply busy;
  busy.message = is_over_waiting(client) ? "busy: this client has as much waiting as one may have"
                                         : "the server is busy";
  busy.retry_after = kRetryAfter;
  registration->done(busy);
}

void Service::announce_registered(const Registration& registration, const RegisterReply& reply) {
  const RobotDescription& description = registration.description;
  if (reply.status == RegisterStatus::Refused) {
    troubles_.add(Trouble::RobotRefused, "'" + description.label + "': " + reply.message);
  } else {
    clients_.count_robot(registration.client, description.label,
                         reply.status == RegisterStatus::Registered);
    options_.log("register '" + description.label +
                 "': " + (reply.status == RegisterStatus::Known ? "known as robot " : "robot ") +
                 reply.robot.short_hex() + "; geometry" +
                 (reply.took_geometry ? ", better than before: " : ": ") + reply.geometry);
  }
  publish_registered(events_, description, reply);
  registration.done(reply);
}

}  // namespace kinship::service
