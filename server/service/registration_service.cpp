#include "server/service/registration_service.hpp"

#include <utility>

#include "server/service/publish_events.hpp"

namespace kinship::service {
namespace {

using runtime::Trouble;
using Priority = runtime::WorkerPool::Priority;

}  // namespace

/// Of a robot. Shared by the threads that answer it, one after the other.
struct RegistrationService::Registration {
  RobotDescription description;
  std::function<void(const RegisterReply&)> done;
  std::string client;
  runtime::RobotRegistry::LabelRule may_take;
};

void RegistrationService::register_robot(RobotDescription description,
                                         std::function<void(const RegisterReply&)> done,
                                         const std::string& client,
                                         runtime::RobotRegistry::LabelRule may_take) {
  const auto registration = std::make_shared<const Registration>(
      Registration{std::move(description), std::move(done), client, std::move(may_take)});
  const auto register_in_store = [this, registration](const runtime::Candidate& robot) {
    announce_registered(*registration,
                        parts_.robots.register_robot(robot, parts_.options.clock.unix_ms(),
                                                     registration->may_take));
  };
  if (!parts_.robots.is_shared())  // registering mends a row that is damaged
    return begin(parts_.pools.store, registration, [registration, register_in_store] {
      register_in_store(runtime::Candidate(registration->description));
    });
  begin(parts_.pools.memory, registration, [this, registration, register_in_store] {
    const Registration& asked = *registration;
    const auto robot = std::make_shared<const runtime::Candidate>(asked.description);
    if (const auto known = parts_.robots.register_known(*robot, asked.may_take))
      return announce_registered(asked, *known);
    begin(parts_.pools.store, registration,
          [robot, register_in_store] { register_in_store(*robot); });
  });
}

/// \param answer  may throw Failure(Storage), std::bad_alloc: a refusal would be final.
void RegistrationService::begin(runtime::WorkerPool& pool, const RegistrationPointer& registration,
                                std::function<void()> answer) {
  const std::string& client = registration->client;
  auto run = [this, registration, answer = std::move(answer)] {
    try {
      answer();
    } catch (const std::exception& exception) {  // a fault of ours, which may pass: it asks again
      parts_.troubles.add(Trouble::RobotUnanswered,
                          "'" + registration->description.label + "': " + exception.what());
    }
  };
  if (pool.submit(Priority::Interactive, {.run = std::move(run), .abandon = {}, .client = client}))
    return;
  parts_.troubles.add(Trouble::RobotUnanswered, "busy or stopping");
  if (parts_.pools.is_stopping())
    return;  // another server may come
  RegisterReply busy;
  busy.message = parts_.pools.busy_message(client);
  busy.retry_after = TaskPools::kRetryAfter;
  registration->done(busy);
}

void RegistrationService::announce_registered(const Registration& registration,
                                              const RegisterReply& reply) {
  const RobotDescription& description = registration.description;
  if (reply.status == RegisterStatus::Refused) {
    parts_.troubles.add(Trouble::RobotRefused, "'" + description.label + "': " + reply.message);
  } else {
    parts_.clients.count_robot(registration.client, description.label,
                               reply.status == RegisterStatus::Registered);
    parts_.options.log("register '" + description.label + "': " +
                       (reply.status == RegisterStatus::Known ? "known as robot " : "robot ") +
                       reply.robot.short_hex() + "; geometry" +
                       (reply.took_geometry ? ", better than before: " : ": ") + reply.geometry);
  }
  publish_registered(parts_.events, description, reply);
  registration.done(reply);
}

void RegistrationService::refuse(const std::string& label, const std::string& why,
                                 const std::function<void(const RegisterReply&)>& done) {
  parts_.troubles.add(Trouble::RobotRefused, "'" + label + "': " + why);
  RegisterReply reply;
  reply.status = RegisterStatus::Refused;
  reply.message = why;
  done(reply);
}

void RegistrationService::find_robots(const std::set<Digest>& robots,
                                      std::function<void(const Robots&)> done,
                                      const std::string& client) {
  Robots known;
  std::set<Digest> others;
  for (const Digest& robot : robots)
    if (auto found = parts_.robots.find_in_memory(robot))
      known.emplace(robot, std::move(found));
    else
      others.insert(robot);
  if (others.empty())
    return done(known);
  // Shared by the task and the answer if there is no room for it: `done` may be large.
  const auto answer = std::make_shared<const std::function<void(const Robots&)>>(std::move(done));
  auto run = [this, known, others, answer]() mutable {
    for (const Digest& robot : others)
      if (auto found = parts_.robots.find(robot);
          found || found.error().code != ErrorCode::NotFound)
        known.emplace(robot, std::move(found));
    (*answer)(known);
  };
  if (parts_.pools.store.submit(Priority::Interactive,
                                {.run = std::move(run), .abandon = {}, .client = client}) ||
      parts_.pools.is_stopping())
    return;
  const Error busy{ErrorCode::Unavailable, parts_.pools.busy_message(client)};
  for (const Digest& robot : others)
    known.emplace(robot, busy);
  (*answer)(known);
}

void RegistrationService::name_robots(const std::set<Digest>& robots,
                                      std::function<void(const RobotLabels&)> done,
                                      const std::string& client) {
  find_robots(
      robots,
      [done = std::move(done)](const Robots& found) {
        RobotLabels labels;
        for (const auto& [digest, robot] : found)
          labels.emplace(digest, robot ? Result<std::string>(robot.value()->label) : robot.error());
        done(labels);
      },
      client);
}

}  // namespace kinship::service
