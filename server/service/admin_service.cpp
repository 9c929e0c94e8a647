#include "server/service/admin_service.hpp"

#include <map>
#include <utility>

#include "server/access/access.hpp"
#include "server/service/publish_events.hpp"
#include "server/service/reply_bytes.hpp"

namespace kinship::service {
namespace {

using runtime::Trouble;

constexpr std::size_t kMaxResets = 16;  // that wait

}  // namespace

AdminService::AdminService(const ServiceParts& parts, const Others& others)
    : parts_(parts),
      others_(others),
      jobs_(parts.options.clock, job_options()),
      administration_(administration_parts()),
      reset_pool_(
          {.threads = 1, .queue_limit = kMaxResets, .niceness = parts.options.fit_niceness}) {}

Jobs::Options AdminService::job_options() {
  return {.limits = parts_.options.jobs,
          .niceness = parts_.options.fit_niceness,
          .on_end = [this](const Job& job) {
            parts_.measures.count(job);
            publish_job(parts_.events, job);
          }};
}

Administration::Parts AdminService::administration_parts() {
  return {.store = others_.store,
          .robots = parts_.robots,
          .jobs = jobs_,
          .clock = parts_.options.clock,
          .guidance = others_.fetches,
          .status = others_.status,
          .memory = &others_.fetches.memory(),
          .clients = [this] { return list_clients(); },
          .backups = parts_.options.backups,
          .stop = parts_.pools.stop_token(),
          .on_change =
              [this](const std::string& task, const std::string& what) {
                parts_.tell(task, what);
                others_.upstream.wake();
              }};
}

std::optional<Error> AdminService::refusal_of(const Caller& caller,
                                              const AdminRequest& request) const {
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
runtime::WorkerPool& AdminService::pool_for(AdminVerb verb) {
  if (rule_of(verb).is(VerbRule::Long))
    return reset_pool_;
  if (verb == AdminVerb::Status)
    return parts_.pools.status;
  return rule_of(verb).is(VerbRule::FromMemory) ? parts_.pools.memory : parts_.pools.store;
}

void AdminService::administer(AdminRequest request, const std::string& request_key,
                              const std::function<void(const AdminPage&)>& done,
                              const Caller& caller) {
  const std::optional<Error> refusal = refusal_of(caller, request);
  if (refusal && !rule_of(request.verb).is(VerbRule::Changes)) {
    const AdminPage page = page_of(*refusal);
    count_refused(page);
    return done(page);
  }
  // From memory, and on the thread that then asks for the next deadline.
  if (request.verb == AdminVerb::ShowJob)
    return jobs_.wait(request.argument, parts_.options.clock.now() + request.deadline,
                      [done](const Result<Job>& job) { done(page_of(job)); });
  runtime::WorkerPool& pool = refusal ? parts_.pools.store : pool_for(request.verb);
  const std::string client(catalog::client_of(request_key));
  auto run = [this, request = std::move(request), request_key, client, done, caller, refusal] {
    const AdminPage page = refusal ? administration_.refuse(request, caller, *refusal)
                                   : administration_.answer(request, request_key, caller);
    if (refusal)
      count_refused(page);
    else
      count(page, client);
    parts_.clients.count_reply(client, reply_bytes(page));
    done(page);
  };
  const auto decline = [this, done, client] {
    AdminPage page;
    page.message = "the server is busy or stopping";
    page.retry_after = TaskPools::kRetryAfter;
    count(page, client);
    done(page);
  };
  if (!pool.submit(runtime::WorkerPool::Priority::Interactive,
                   {.run = std::move(run), .abandon = decline, .client = client})) {
    parts_.pools.is_over_waiting(client);
    decline();
  }
}

/// A mistyped name is no trouble of the server; a store that is away is.
void AdminService::count(const AdminPage& page, const std::string& client) {
  if (page.status == AdminStatus::Failed ||
      (page.status != AdminStatus::Ok && page.error == ErrorCode::Unavailable))
    parts_.troubles.add(Trouble::AdminFailed, page.message);
  else if (page.status != AdminStatus::Ok)
    parts_.clients.count_bad_request(client);
}

/// Of a caller without the right.
void AdminService::count_refused(const AdminPage& page) {
  parts_.troubles.add(Trouble::AdminRefused, page.message);
}

/// Of clients that have quotas; a follower that was forgotten since is left out.
std::vector<ClientUse> AdminService::list_clients() const {
  std::vector<ClientUse> rows = parts_.clients.list();
  const std::map<std::string, catalog::ClientHolds> holds =
      others_.fetches.catalog().holds_of_clients();
  const std::map<std::string, std::size_t> on_way = others_.reports.ingest().queued_of_clients();
  for (ClientUse& row : rows) {
    if (const auto found = holds.find(row.client); found != holds.end()) {
      row.waiting = found->second.waiters;
      row.leases = found->second.leases;
      row.fits = found->second.fits;
    }
    if (const auto found = on_way.find(row.client); found != on_way.end())
      row.on_way = found->second;
  }
  return rows;
}

void AdminService::stop() {
  jobs_.stop();
  reset_pool_.stop(runtime::WorkerPool::Leftovers::Abandon);
}

}  // namespace kinship::service
