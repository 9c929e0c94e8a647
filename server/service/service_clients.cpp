// The quotas of a service's clients, and their use.

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "server/service/reply_bytes.hpp"
#include "server/service/service.hpp"

namespace kinship::service {
namespace {

using quotas::Quota;
using quotas::Refusal;
using runtime::Trouble;

}  // namespace

std::size_t reply_bytes(const FetchReply& reply) {
  constexpr std::size_t kFixedBytes = 512, kSourceBytes = 256, kPathBytes = 96, kPoseBytes = 28;
  std::size_t bytes = kFixedBytes;
  if (reply.distribution) {
    bytes += kSourceBytes * reply.distribution->sources.size();
    if (const auto& mixture = reply.distribution->mixture) {
      const auto components = static_cast<std::size_t>(mixture->size());
      const auto dimension = static_cast<std::size_t>(mixture->dimension());
      const std::size_t triangle = dimension * (dimension + 1) / 2;
      bytes += sizeof(double) *
               (components * (1 + dimension) + mixture->covariances().size() * triangle);
    }
  }
  if (reply.experience)
    for (const auto& path : reply.experience->paths)
      bytes += kPathBytes + kPoseBytes * path.poses.size();
  return bytes;
}

std::size_t reply_bytes(const AdminPage& page) {
  constexpr std::size_t kRowBytes = 512;
  std::size_t bytes = kRowBytes;
  for (const AdminRow& row : page.rows) {
    const auto* const line = std::get_if<TextLine>(&row);
    bytes += line != nullptr ? line->text.size() : kRowBytes;
  }
  return bytes;
}

std::optional<Refusal> Service::admit(const std::string& client, std::size_t bytes,
                                      std::size_t attempts) {
  return refused(clients_.admit(client, bytes, attempts));
}

std::optional<Refusal> Service::admit_robot(const std::string& client, std::size_t bytes) {
  if (auto refusal = clients_.may_add(client, Quota::Robots))
    return refused(std::move(refusal));
  return admit(client, bytes);
}

std::optional<Refusal> Service::refused(std::optional<Refusal> refusal) {
  if (refusal)
    troubles_.add(Trouble::ClientQuota, refusal->message);
  return refusal;
}

std::optional<Refusal> Service::may_begin_task(const std::string& client, const std::string& task) {
  if (!store_->find_task(task))
    return refused(clients_.may_add(client, Quota::Tasks));
  known_tasks_.add(task);
  return std::nullopt;
}

/// Whether a client itself filled its place in a queue; then that is counted.
bool Service::is_over_waiting(const std::string& client) {
  if (client.empty() || options_.client_short_tasks == 0 ||
      std::max({short_task_pool_.queued_of(client), memory_task_pool_.queued_of(client),
                status_pool_.queued_of(client)}) < options_.client_short_tasks)
    return false;
  clients_.count_refusal(client, Quota::Waiting);
  return true;
}

std::size_t Service::short_tasks() const {
  return short_task_pool_.queued() + memory_task_pool_.queued() + status_pool_.queued();
}

Ingest::Options Service::ingest_options() {
  Ingest::Options ingest;
  ingest.max_attempts = options_.max_queued_attempts;
  ingest.client_attempts = options_.client_attempts;
  ingest.on_over_quota = [this](const std::string& client, const std::string& message) {
    clients_.count_refusal(client, Quota::Waiting);
    troubles_.add(Trouble::ReportQuota, message);
  };
  ingest.is_known_task = [this](const std::string& task) { return known_tasks_.has(task); };
  ingest.may_begin_task = [this](const std::string& client, const std::string& task) {
    return may_begin_task(client, task);
  };
  ingest.on_kept = [this](const std::string& client, const std::string& task, std::size_t bytes) {
    if (known_tasks_.add(task))
      clients_.count_task(client);
    clients_.count_stored(client, bytes);
  };
  ingest.on_new_experience = [this](std::string_view task) { new_experience(task); };
  ingest.on_answer = [this](std::span<const catalog::AttemptCost> costs,
                            std::span<const Receipt> receipts) { answered(costs, receipts); };
  return ingest;
}

/// Of clients that have quotas; a follower that was forgotten since is left out.
std::vector<ClientUse> Service::list_clients() const {
  std::vector<ClientUse> rows = clients_.list();
  const std::map<std::string, catalog::ClientHolds> holds = catalog_.holds_of_clients();
  const std::map<std::string, std::size_t> on_way = ingest_.queued_of_clients();
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

}  // namespace kinship::service
