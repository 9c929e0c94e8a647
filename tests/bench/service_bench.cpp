// What a fetch costs inside the server: a cold one (500 paths of a Panda to a UR10e, one thread),
// and one that is answered from memory. Store and robots are real, DDS is not part of it.

#include <benchmark/benchmark.h>

#include <future>
#include <memory>

#include "server/service/service.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::service {
namespace {

constexpr std::uint64_t kPaths = 500;

class Server {
 public:
  Server() {
    ServiceOptions options;
    options.fit_niceness = 0;
    service_ =
        std::make_unique<Service>(store::open_sqlite_store(directory_ / "fleet.db"), options);
    panda_ = register_model("panda");
    request_.robot = register_model("ur10e");
    request_.task = "sweep";
    request_.deadline = std::chrono::minutes(5);
    std::promise<void> done;
    ReportRequest report;
    for (std::uint64_t i = 0; i < kPaths; ++i)
      report.attempts.push_back(test::panda_attempt(panda_, "sweep", i));
    service_->report(std::move(report), [&](const ReportReply&) { done.set_value(); });
    done.get_future().wait();
  }

  /// Another distribution for another x.
  FetchReply fetch(double x_m) {
    FetchRequest request = request_;
    request.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
    std::promise<FetchReply> reply;
    service_->fetch(request, "bench", [&](const FetchReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }

 private:
  Digest register_model(const std::string& name) {
    std::promise<Digest> robot;
    service_->register_robot(test::model_description(name),
                             [&](const RegisterReply& r) { robot.set_value(r.robot); });
    return robot.get_future().get();
  }

  test::TemporaryDirectory directory_{test::disk_root()};
  std::unique_ptr<Service> service_;
  Digest panda_;
  FetchRequest request_;
};

void cold_fetch(benchmark::State& state) {
  Server server;
  double x_m = 0;
  Distribution distribution;
  for (auto _ : state)
    distribution = server.fetch(x_m += 0.002).distribution.value();
  state.counters["poses"] = static_cast<double>(distribution.sources[0].poses);
  state.counters["configurations"] = static_cast<double>(distribution.configurations);
  state.counters["transfer_s"] = distribution.transfer_time_s;
  state.counters["fit_s"] = distribution.fit_time_s;
}
BENCHMARK(cold_fetch)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);

void fetch_from_memory(benchmark::State& state) {
  Server server;
  server.fetch(0);
  for (auto _ : state)
    benchmark::DoNotOptimize(server.fetch(0));
}
BENCHMARK(fetch_from_memory)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace kinship::service

BENCHMARK_MAIN();
