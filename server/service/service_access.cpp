#include <memory>
#include <string>
#include <utility>

#include "server/access/access.hpp"
#include "server/service/reply_bytes.hpp"
#include "server/service/service.hpp"

namespace kinship::service {

std::optional<Error> Service::refusal_of(const Caller& caller, const AdminRequest& request) const {
  if (auto refusal = access::refusal_of(caller, request.verb))
    return refusal;
  if (rule_of(request.verb).argument != VerbArgument::Job)
    return std::nullopt;
  const std::optional<std::string> owner = jobs_.owner_of(request.argument);
  if (!owner || *owner == caller.client)
    return std::nullopt;
  return access::refusal_of_job(caller, request.verb, request.argument);
}

/// Where it waits for no task that may take long, and none waits for it.
runtime::WorkerPool& Service::pool_for(AdminVerb verb) {
  if (rule_of(verb).is(VerbRule::Long))
    return reset_pool_;
  if (verb == AdminVerb::Status)
    return status_pool_;
  return rule_of(verb).is(VerbRule::FromMemory) ? memory_task_pool_ : short_task_pool_;
}

void Service::administer(AdminRequest request, const std::string& request_key,
                         const std::function<void(const AdminPage&)>& done, const Caller& caller) {
  const std::optional<Error> refusal = refusal_of(caller, request);
  if (refusal && !rule_of(request.verb).is(VerbRule::Changes)) {
    const AdminPage page = page_of(*refusal);
    count_admin(page);
    return done(page);
  }
  // From memory, and on the thread that then asks for the next deadline.
  if (request.verb == AdminVerb::ShowJob)
    return jobs_.wait(request.argument, options_.clock.now() + request.deadline,
                      [done](const Result<Job>& job) { done(page_of(job)); });
  runtime::WorkerPool& pool = refusal ? short_task_pool_ : pool_for(request.verb);
  const std::string client(catalog::client_of(request_key));
  auto run = [this, request = std::move(request), request_key, client, done, caller, refusal] {
    const AdminPage page = refusal ? administration_.refuse(request, caller, *refusal)
                                   : administration_.answer(request, request_key, caller);
    count_admin(page);
    clients_.count_reply(client, reply_bytes(page));
    done(page);
  };
  const auto decline = [this, done] {
    AdminPage page;
    page.message = "the server is busy or stopping";
    page.retry_after = kRetryAfter;
    count_admin(page);
    done(page);
  };
  if (!pool.submit(runtime::WorkerPool::Priority::Interactive,
                   {.run = std::move(run), .abandon = decline, .client = client})) {
    is_over_waiting(client);
    decline();
  }
}

void Service::name_robots(const std::set<Digest>& robots,
                          std::function<void(const RobotLabels&)> done, const std::string& client) {
  RobotLabels labels;
  std::set<Digest> others;
  for (const Digest& robot : robots)
    if (const auto known = robots_.find_in_memory(robot))
      labels.emplace(robot, known->label);
    else
      others.insert(robot);
  if (others.empty())
    return done(labels);
  // Shared by the task and the answer if there is no room for it: `done` may be large.
  const auto answer =
      std::make_shared<const std::function<void(const RobotLabels&)>>(std::move(done));
  auto run = [this, labels, others, answer]() mutable {
    for (const Digest& robot : others)
      if (const auto found = robots_.find(robot))
        labels.emplace(robot, found.value()->label);
      else if (found.error().code != ErrorCode::NotFound)
        labels.emplace(robot, found.error());
    (*answer)(labels);
  };
  if (short_task_pool_.submit(runtime::WorkerPool::Priority::Interactive,
                              {.run = std::move(run), .abandon = {}, .client = client}) ||
      stop_source_.stop_requested())
    return;
  const Error busy{ErrorCode::Unavailable,
                   is_over_waiting(client) ? "busy: this client has as much waiting as one may have"
                                           : "the server is busy"};
  for (const Digest& robot : others)
    labels.emplace(robot, busy);
  (*answer)(labels);
}

void Service::refuse_registration(const std::string& label, const std::string& why,
                                  const std::function<void(const RegisterReply&)>& done) {
  troubles_.add(runtime::Trouble::RobotRefused, "'" + label + "': " + why);
  RegisterReply reply;
  reply.status = RegisterStatus::Refused;
  reply.message = why;
  done(reply);
}

void Service::refuse_fetch(const std::string& why,
                           const std::function<void(const FetchReply&)>& done) {
  FetchReply reply;
  reply.status = FetchStatus::Refused;
  reply.message = why;
  count_fetch(reply);
  done(reply);
}

void Service::postpone_fetch(const std::string& why,
                             const std::function<void(const FetchReply&)>& done) {
  FetchReply reply;
  reply.status = FetchStatus::Busy;
  reply.message = why;
  reply.retry_after = kRetryAfter;
  count_fetch(reply);
  done(reply);
}

}  // namespace kinship::service
