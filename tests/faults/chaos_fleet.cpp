#include "tests/faults/chaos_fleet.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <thread>
#include <utility>

namespace kinship::test {
namespace {

using std::chrono::milliseconds;

/// Variables of the environment, for what is started while it lives.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::string>& variables)
      : variables_(variables) {
    for (const auto& [name, value] : variables_)
      setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    for (const auto& [name, value] : variables_)
      unsetenv(name.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const std::map<std::string, std::string> variables_;
};

}  // namespace

milliseconds Dice::time(milliseconds from, milliseconds to) {
  return from + milliseconds(below(static_cast<std::size_t>((to - from).count()) + 1));
}

JumpingClock::JumpingClock(std::filesystem::path file) : file_(std::move(file)) {
  jump_to(std::chrono::seconds(0));
}

void JumpingClock::jump_to(std::chrono::seconds ahead) const {
  const std::int64_t seconds = ahead.count();
  const int file = open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  EXPECT_EQ(pwrite(file, &seconds, sizeof seconds, 0), ssize_t{sizeof seconds}) << file_;
  close(file);
}

std::unique_ptr<Program> JumpingClock::start(const std::string& name,
                                             const std::vector<std::string>& arguments,
                                             const std::filesystem::path& log) const {
  const Environment environment(
      {{"LD_PRELOAD", KINSHIP_JUMPING_CLOCK}, {"KINSHIP_CLOCK", file_.string()}});
  return std::make_unique<Program>(name, arguments, log);
}

Supervised::Supervised(const JumpingClock& clock, std::string name, std::filesystem::path log,
                       std::function<std::vector<std::string>()> arguments)
    : clock_(clock),
      name_(std::move(name)),
      log_(std::move(log)),
      arguments_(std::move(arguments)) {}

void Supervised::start() { program_ = clock_.start(name_, arguments_(), log_); }

void Supervised::keep_up() {
  if (program_ && !program_->has_ended())
    return;
  if (program_) {
    const int status = program_->wait();
    EXPECT_LT(status, 128) << name_ << " crashed; its log: " << log_;
    const std::string log = read_text(log_);
    const std::size_t end = log.find_last_not_of('\n'), begin = log.rfind('\n', end);
    std::cout << "  " << name_ << " ended with " << status << ": "
              << log.substr(begin == std::string::npos ? 0 : begin + 1, end - begin) << std::endl;
  }
  start();
}

void Supervised::kill() {
  program_->kill();
  program_.reset();
}

void Supervised::kill_and_start() {
  kill();
  start();
}

int Supervised::terminate() {
  program_->signal(SIGTERM);
  const int status = program_->wait();
  program_.reset();
  EXPECT_TRUE(status < 128 || status == 128 + SIGTERM) << name_ << " crashed; its log: " << log_;
  return status;
}

void Supervised::freeze_for(milliseconds time) const {
  program_->signal(SIGSTOP);
  std::this_thread::sleep_for(time);
  program_->signal(SIGCONT);
}

ChaosClients::ChaosClients(std::filesystem::path folder, const JumpingClock& clock,
                           std::vector<Place> places, std::size_t count)
    : folder_(std::move(folder)), places_(std::move(places)) {
  for (std::size_t client = 0; client < count; ++client)
    clients_.push_back(
        std::make_unique<Supervised>(clock, "../tests/faults_fleet", folder_ / "clients.log",
                                     [this, client] { return arguments_of(client); }));
}

std::vector<std::string> ChaosClients::arguments_of(std::size_t client) {
  constexpr std::uint64_t kNumbersPerLife = 10'000'000;
  constexpr milliseconds kPause{10};
  const Place& place = places_[client % places_.size()];
  const std::size_t last = clients_.size() - 1;
  const std::size_t shared = last < places_.size() ? 0 : last - places_.size();
  const std::size_t outbox = client == last ? shared : client;
  ++lives_;
  std::vector<std::string> arguments = {"report",
                                        std::to_string(place.domain),
                                        (folder_ / ("outbox-" + std::to_string(outbox))).string(),
                                        (folder_ / ("ledger-" + std::to_string(lives_))).string(),
                                        std::to_string(lives_ * kNumbersPerLife),
                                        std::to_string(kPause.count())};
  if (!place.credentials.empty())
    arguments.push_back(place.credentials.string());
  return arguments;
}

void ChaosClients::start_all() {
  for (const auto& client : clients_)
    client->start();
}

void ChaosClients::keep_up() {
  for (const auto& client : clients_)
    client->keep_up();
}

void ChaosClients::drain() {
  for (const auto& client : clients_)
    EXPECT_EQ(client->program().read_line(), "started");
  for (const auto& client : clients_)
    client->program().signal(SIGTERM);
  for (const auto& client : clients_) {
    EXPECT_EQ(client->program().read_line(), "pending 0 refused 0");
    EXPECT_EQ(client->program().wait(), 0) << read_text(client->log());
  }
}

ReportLedger ChaosClients::ledger() const {
  ReportLedger ledger;
  for (std::uint64_t life = 1; life <= lives_; ++life)
    ledger.read(folder_ / ("ledger-" + std::to_string(life)));
  return ledger;
}

void run_chaos(std::uint64_t seed, std::chrono::seconds time,
               const std::vector<Nuisance>& nuisances, const std::function<void()>& keep_up) {
  using Clock = std::chrono::steady_clock;
  Dice dice(seed);
  std::map<std::string, int> counts;
  const Clock::time_point begin = Clock::now();
  while (Clock::now() - begin < time && !testing::Test::HasFailure()) {
    std::this_thread::sleep_for(dice.time(milliseconds(0), milliseconds(1500)));
    keep_up();
    const Nuisance& nuisance = nuisances[dice.below(nuisances.size())];
    Dice own(dice.below(1U << 30U));  // a nuisance that draws more does not shift the next ones
    const std::chrono::duration<double> since = Clock::now() - begin;
    std::cout << "  " << since.count() << " s: " << nuisance.name << std::endl;
    ++counts[nuisance.name];
    nuisance.happen(own);
    keep_up();
  }
  std::cout << "seed " << seed << ':';
  for (const auto& [name, count] : counts)
    std::cout << ' ' << count << " x " << name << ',';
  std::cout << std::endl;
}

}  // namespace kinship::test
