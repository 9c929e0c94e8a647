#include "tests/faults/store_fleet.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

namespace kinship::test {

StoreFleet::StoreFleet(const Options& options) : options_(options), servers_(options.servers) {}

StoreFleet::~StoreFleet() {
  for (std::size_t server = 0; server < servers_.size(); ++server)
    kill(server);
}

void StoreFleet::start(std::size_t server, const std::string& store) {
  Server& started = servers_.at(server);
  started.process = std::make_unique<Program>(
      "../tests/faults_postgres",
      std::vector<std::string>{"clients", store, history_file(server),
                               std::to_string(options_.clients),
                               std::to_string(server * options_.clients),
                               options_.requires_standby ? "synchronous" : "any"},
      folder_ / "log");
  {
    const std::lock_guard lock(mutex_);
    ++running_;
  }
  started.listener = std::thread([this, &started] { listen(*started.process); });
}

void StoreFleet::start_all(const std::string& store) {
  for (std::size_t server = 0; server < servers_.size(); ++server)
    start(server, store);
}

void StoreFleet::kill(std::size_t server) {
  Server& killed = servers_.at(server);
  if (!killed.process)
    return;
  killed.process->signal(SIGKILL);
  killed.listener.join();  // reads what was said until the end
  killed.process.reset();
}

bool StoreFleet::wait_for_answers(std::uint64_t more, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const std::uint64_t wanted = answers_ + more;
  return changed_.wait_for(lock, patience, [&] { return answers_ >= wanted; });
}

std::uint64_t StoreFleet::answers() const {
  const std::lock_guard lock(mutex_);
  return answers_;
}

bool StoreFleet::end() {
  for (const Server& server : servers_)
    if (server.process)
      server.process->signal(SIGTERM);
  constexpr std::chrono::minutes kPatience{2};
  bool is_in_order = true;
  {
    std::unique_lock lock(mutex_);
    is_in_order = changed_.wait_for(lock, kPatience, [&] { return running_ == 0; });
  }
  for (Server& server : servers_) {
    if (!server.process)
      continue;
    if (!is_in_order)
      server.process->signal(SIGKILL);
    server.listener.join();
    is_in_order &= server.process->wait() == 0;
    server.process.reset();
  }
  return is_in_order;
}

std::vector<HistoryEntry> StoreFleet::history() const {
  std::vector<HistoryEntry> all;
  for (std::size_t server = 0; server < servers_.size(); ++server) {
    const std::vector<HistoryEntry> entries = read_history(history_file(server));
    all.insert(all.end(), entries.begin(), entries.end());
  }
  return all;
}

std::string StoreFleet::log() const {
  constexpr std::size_t kShown = 4000;
  const std::string all = read_text(folder_ / "log");
  return all.substr(all.size() - std::min(all.size(), kShown));
}

void StoreFleet::listen(Program& process) {
  while (!process.read_line().empty()) {
    const std::lock_guard lock(mutex_);
    ++answers_;
    changed_.notify_all();
  }
  const std::lock_guard lock(mutex_);
  --running_;
  changed_.notify_all();
}

std::filesystem::path StoreFleet::history_file(std::size_t server) const {
  return folder_ / ("history-" + std::to_string(server)).c_str();
}

}  // namespace kinship::test
