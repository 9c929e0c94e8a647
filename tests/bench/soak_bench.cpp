// A server under reports, fits, fetches and clients that come and go, for a long time: whether what
// it takes of the machine goes on growing. Exit code 1 if it does, or if a client got no answer.
//
//   soak_bench [--minutes N]

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;

constexpr double kMinutes = 20;
constexpr int kShortLived = 10;  // clients of a process that lives for a moment

/// What the server took at one moment.
struct Sample {
  test::ProcessFigures process;
  double wal_mb = 0;
};

/// A process of clients that ask for the status and the distribution once, one after the other; it
/// ends without a word to the server.
int run_short_lived(std::uint32_t domain, const Digest& robot) {
  for (int i = 0; i < kShortLived; ++i) {
    link::Client client(bench::without_outbox(domain));
    if (client.admin({}).value_or_throw().status != AdminStatus::Ok ||
        client.fetch(bench::request_for(robot)).value_or_throw().status != FetchStatus::Ready)
      return 1;
    if (i + 1 == kShortLived) {
      std::cout << "answered" << std::endl;
      std::raise(SIGKILL);
    }
  }
  return 1;
}

/// Fetches what is in memory, 100 times a second.
[[noreturn]] void run_fetches(std::uint32_t domain, const Digest& robot) {
  link::Client client(bench::without_outbox(domain));
  while (true) {
    client.fetch(bench::request_for(robot)).value_or_throw();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

class Soak {
 public:
  Soak() {
    link::Client client(bench::without_outbox(domain_.number()));
    panda_ = bench::teach(client, 100);
  }

  std::vector<Sample> run(double minutes) {
    constexpr auto kReportsPerS = "50";
    std::vector<std::unique_ptr<test::ChildProcess>> load;
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"reports", kReportsPerS, "0"}, {"fits"}, {"fetches"}}) {
      std::vector<std::string> command = {"/proc/self/exe", more[0],
                                          std::to_string(domain_.number()), panda_.hex()};
      command.insert(command.end(), more.begin() + 1, more.end());
      load.push_back(std::make_unique<test::ChildProcess>(command));
    }
    std::vector<Sample> samples;
    const double end_s = bench::wall_s() + 60 * minutes;
    double next_line_s = 0;
    while (bench::wall_s() < end_s) {
      live_shortly();
      samples.push_back({test::figures_of(server_.pid()), size_mb("fleet.db-wal")});
      if (bench::wall_s() >= next_line_s) {
        say(samples.back());
        next_line_s = bench::wall_s() + 10;
      }
    }
    for (const auto& process : load)
      if (kill(process->pid(), 0) != 0 || has_ended(process->pid()))
        throw std::runtime_error("a client of the load has ended");
    return samples;
  }

 private:
  void live_shortly() const {
    test::ChildProcess process = bench::start_role("short-lived", domain_.number(), panda_);
    if (process.read_line() != "answered")
      throw std::runtime_error("a client that came for a moment got no answer");
    process.wait();
  }
  double size_mb(const char* name) const {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(directory_ / name, none);
    return none ? 0 : static_cast<double>(bytes) / 1e6;
  }
  void say(const Sample& sample) const {
    std::cerr << sample.process.resident_mb << " MB, " << sample.process.threads << " threads, "
              << sample.process.descriptors << " descriptors, WAL " << sample.wal_mb
              << " MB, store " << size_mb("fleet.db") << " MB\n";
  }
  /// Ended, and not yet waited for.
  static bool has_ended(pid_t process) {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == process;
  }

  const test::ReservedDomain domain_;
  const test::TemporaryDirectory directory_{test::disk_root()};
  const test::ServerProcess server_{
      {.store = directory_ / "fleet.db",
       .domain = domain_.number(),
       .arguments = {"--client-mb-per-s", "0", "--client-attempts-per-s", "0"}}};
  Digest panda_;
};

using Value = std::function<double(const Sample&)>;

std::vector<double> part_of(const std::vector<Sample>& samples, double from, double to,
                            const Value& value) {
  const auto size = static_cast<double>(samples.size());
  std::vector<double> values;
  for (auto i = static_cast<std::size_t>(from * size); i < static_cast<std::size_t>(to * size); ++i)
    values.push_back(value(samples[i]));
  return values;
}

/// The first third warms up. Growth: from the median of the second third to that of the last.
/// \return whether it is within the budget.
bool judge_growth(const std::vector<Sample>& samples, const std::string& of,
                  const std::string& unit, double budget, const Value& value) {
  const double before = bench::median(part_of(samples, 1.0 / 3, 2.0 / 3, value));
  const double after = bench::median(part_of(samples, 2.0 / 3, 1, value));
  bench::print(
      {.name = "growth of " + of + " after the warm-up",
       .value = after - before,
       .unit = unit,
       .budget = budget,
       .note = std::to_string(samples.size()) + " samples, at the end " + std::to_string(after)});
  return after - before <= budget;
}

/// \return whether all is within the budgets.
bool judge(const std::vector<Sample>& samples) {
  constexpr double kMinSamples = 6;
  if (static_cast<double>(samples.size()) < kMinSamples)
    throw std::runtime_error("too short to see growth");
  const bool memory = judge_growth(samples, "memory", "MB", 10,
                                   [](const Sample& s) { return s.process.resident_mb; });
  const bool threads = judge_growth(samples, "threads", "threads", 2, [](const Sample& s) {
    return static_cast<double>(s.process.threads);
  });
  const bool descriptors =
      judge_growth(samples, "descriptors", "descriptors", 2,
                   [](const Sample& s) { return static_cast<double>(s.process.descriptors); });
  constexpr double kMaxWal_mb = 64;
  const std::vector<double> wal = part_of(samples, 0, 1, [](const Sample& s) { return s.wal_mb; });
  const double longest_mb = *std::ranges::max_element(wal);
  bench::print({.name = "longest WAL", .value = longest_mb, .unit = "MB", .budget = kMaxWal_mb});
  return memory && threads && descriptors && longest_mb <= kMaxWal_mb;
}

bool run_soak_role(const std::vector<std::string>& arguments) {
  if (arguments.size() != 3 || (arguments[0] != "fetches" && arguments[0] != "short-lived"))
    return bench::run_role(arguments);
  const auto domain = static_cast<std::uint32_t>(std::stoul(arguments[1]));
  const Digest robot = Digest::from_hex(arguments[2]).value();
  if (arguments[0] == "fetches")
    run_fetches(domain, robot);
  std::exit(run_short_lived(domain, robot));
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (run_soak_role(arguments))
    return 0;
  double minutes = kMinutes;
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i)
    if (arguments[i] == "--minutes")
      minutes = std::stod(arguments[i + 1]);
  try {
    return judge(Soak().run(minutes)) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "soak_bench: " << error.what() << "\n";
    return 1;
  }
}
