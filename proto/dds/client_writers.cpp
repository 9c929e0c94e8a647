#include "proto/dds/client_writers.hpp"

#include <dds/dds.h>

#include <cstring>
#include <set>
#include <utility>
#include <vector>

#include "proto/dds/loan.hpp"
#include "proto/dds/matched_writers.hpp"
#include "proto/security/permissions.hpp"

namespace kinship::dds {
namespace {

/// A reader that was discovered matches soon after; one that has gone may come again.
constexpr std::chrono::seconds kKept{30};
constexpr std::chrono::seconds kBetweenSweeps{10};
constexpr std::chrono::seconds kBetweenLooks{1};  // as often as the directory reads a record
/// Readers are noticed before their permissions are checked, so names may be made up.
constexpr std::size_t kMaxUnknown = 1024;

bool has_same_rights(const Caller& one, const Caller& other) {
  return one.role == other.role && one.tasks == other.tasks && one.robots == other.robots;
}

}  // namespace

ClientWriters::ClientWriters(const Participant& participant, WaitLoop& loop, const Entity& topic,
                             std::string name, Qos qos, MatchedReaders* matched_readers)
    : participant_(participant.get()),
      directory_(participant.options().directory),
      topic_(topic.get()),
      name_(std::move(name)),
      qos_(std::move(qos)),
      matched_readers_(matched_readers),
      readers_(
          dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
          "reader of readers") {
  loop.attach(readers_,
              [this] { return notice_readers() ? WaitLoop::kAgain : WaitLoop::kWithSamples; });
  loop.every(kBetweenLooks, [this] { look_again(); });
}

std::shared_ptr<const Entity> ClientWriters::of(const std::string& name) {
  if (auto known = find(name))
    return known;
  if (auto made = make(name, {}))
    return made;
  return find(name);  // another thread was faster
}

std::shared_ptr<const Entity> ClientWriters::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto known = writers_.find(name);
  if (known == writers_.end())
    return nullptr;
  known->second.used = Clock::now();
  return known->second.writer;
}

std::shared_ptr<const Entity> ClientWriters::make(const std::string& name, const Caller& rights) {
  if (find(name))
    return nullptr;
  const std::string partition = security::client_partition(name);
  const auto publisher = std::make_shared<const Entity>(
      dds_create_publisher(participant_, partition_qos(partition).get(), nullptr),
      "publisher " + partition);
  const std::shared_ptr<const Entity> writer(
      new Entity(
          matched_readers_
              ? matched_readers_->make_writer(*publisher, topic_, qos_.get(), "writer " + name_)
              : Entity(dds_create_writer(publisher->get(), topic_, qos_.get(), nullptr),
                       "writer " + name_)),
      [publisher](const Entity* each) { delete each; });  // before its publisher
  free_unread(Clock::now());
  const std::lock_guard lock(mutex_);
  return writers_.try_emplace(name, Writer{writer, Clock::now(), rights}).second ? writer : nullptr;
}

void ClientWriters::for_each(
    const std::function<void(const std::string& name, const Entity& writer)>& use) const {
  std::vector<std::pair<std::string, std::shared_ptr<const Entity>>> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, each] : writers_)
      all.emplace_back(name, each.writer);
  }
  for (const auto& [name, writer] : all)
    use(name, *writer);
}

bool ClientWriters::notice_readers() {
  std::set<std::string> clients;
  const Loan discovered(readers_, "readers of " + name_);
  for (std::size_t i = 0; i < discovered.size(); ++i) {
    if (!discovered[i])
      continue;
    const auto& reader = *static_cast<const dds_builtintopic_endpoint_t*>(discovered[i]);
    if (reader.topic_name != name_)
      continue;
    if (const auto name = client_of_partitions(reader.qos))
      clients.insert(*name);
  }
  for (const std::string& name : clients)
    let_in(name);
  free_unread(Clock::now());
  return discovered.size() == Loan::kMaxSamples;
}

void ClientWriters::let_in(const std::string& name) {
  const auto caller = directory_ ? directory_(name) : Result<Caller>(Error{});
  if (!caller) {  // an unknown client hears nothing; its record may come, or be readable again
    if (unknown_.size() < kMaxUnknown)
      unknown_.insert(name);
    return;
  }
  unknown_.erase(name);
  if (const auto made = make(name, *caller); made && on_new_)
    on_new_(name, *made);
}

void ClientWriters::look_again() {
  const std::set<std::string> unknown = unknown_;
  for (const std::string& name : unknown)
    let_in(name);
  if (on_new_)
    replace_changed();
  free_unread(Clock::now());
}

/// Samples that a writer keeps for late readers are for the rights that its client had.
void ClientWriters::replace_changed() {
  std::map<std::string, Caller> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, each] : writers_)
      all.emplace(name, each.rights);
  }
  for (const auto& [name, rights] : all) {
    const auto caller = directory_ ? directory_(name) : Result<Caller>(Error{});
    if (caller && has_same_rights(*caller, rights))
      continue;
    {
      std::unique_lock lock(mutex_);
      const auto outdated = writers_.extract(name);
      lock.unlock();  // freed without it
    }
    let_in(name);
  }
}

void ClientWriters::free_unread(Clock::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    if (now - swept_ < kBetweenSweeps)
      return;
    swept_ = now;
  }
  std::set<std::string> read;
  for_each([&](const std::string& name, const Entity& writer) {
    if (dds_get_matched_subscriptions(writer.get(), nullptr, 0) > 0)
      read.insert(name);
  });
  std::vector<Writer> unread;  // freed without the lock
  const std::lock_guard lock(mutex_);
  for (auto place = writers_.begin(); place != writers_.end();) {
    Writer& each = place->second;
    if (read.contains(place->first))
      each.used = now;
    if (now - each.used < kKept) {
      ++place;
      continue;
    }
    unread.push_back(std::move(each));
    place = writers_.erase(place);
  }
}

}  // namespace kinship::dds
