// One-shot commands against a local server, process start to process end.
//
//   command_bench

#include <stdexcept>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using std::chrono::seconds;

constexpr int kTimes = 30;

void measure(const std::string& name, const std::vector<std::string>& arguments) {
  std::vector<double> times_ms;
  for (int i = 0; i < kTimes; ++i) {
    const double start_s = bench::wall_s();
    test::Program program("kinship", arguments);
    program.read_all();
    if (program.wait() != 0)
      throw std::runtime_error("kinship " + name + " failed");
    times_ms.push_back(1e3 * (bench::wall_s() - start_s));
  }
  bench::print({.name = "kinship " + name + ", p50",
                .value = bench::median(times_ms),
                .unit = "ms",
                .budget = 30,
                .note = "slowest of " + std::to_string(kTimes) + ": " +
                        std::to_string(std::lround(bench::percentile(times_ms, 1))) + " ms"});
}

}  // namespace

int main() {
  const test::ReservedDomain domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  const test::ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  {
    link::Client client({.domain = domain.number(), .outbox = directory / "outbox"});
    const Digest panda =
        client.register_robot(test::model_description("panda")).value_or_throw().robot;
    for (std::uint64_t i = 0; i < 20; ++i)
      client.report(test::panda_attempt(panda, "sweep", i));
    client.flush(seconds(60));
  }
  const std::string number = std::to_string(domain.number());
  measure("status", {"--domain", number, "status"});
  measure("distributions fetch",  // the first has it made, the others find it
          {"--domain", number, "distributions", "fetch", "--task", "sweep", "--robot", "panda",
           "--wait", "60"});
  return 0;
}
