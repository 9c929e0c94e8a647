// Durable reports of 8 KB per second against appending as many bytes with fdatasync, in turn, in
// the current directory, which is on the disk to be measured.
//
//   report_bench

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/durable_reports.hpp"
#include "tests/bench/figure.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kBytes = 8192;

void raw_appends(const std::filesystem::path& file, double seconds, bench::Seen& seen) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const std::vector<char> block(kBytes, 'x');
  const double begin_s = bench::wall_s();
  while (bench::wall_s() < begin_s + seconds) {
    const double start_s = bench::wall_s();
    if (write(descriptor, block.data(), block.size()) < 0 || fdatasync(descriptor) != 0) {
      std::cerr << "report_bench: cannot write " << file << "\n";
      std::exit(1);
    }
    seen.latencies_ms.push_back(1e3 * (bench::wall_s() - start_s));
  }
  close(descriptor);
  seen.seconds += bench::wall_s() - begin_s;
}

void print(const std::string& name, const bench::Seen& seen, const bench::Reference& reference,
           double ratio_budget) {
  bench::print({.name = name,
                .value = seen.per_s(),
                .unit = "reports/s",
                .better = bench::Better::Higher,
                .reference = reference,
                .ratio_budget = ratio_budget,
                .note = seen.latencies()});
}

int run() {
  const std::filesystem::path file = "report_bench-" + std::to_string(getpid());
  bench::Seen raw, one, sixteen;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    if (!store->register_robot(bench::reporting_robot()))
      return 1;
    const auto report_ms = [&](std::size_t, std::mt19937_64& generator) {
      return bench::report_once(*store, "bench", generator);
    };
    constexpr int kRounds = 5;  // taken in turn, because the disk's own rate comes and goes
    constexpr double kRound_s = 0.8;
    for (int round = 0; round < kRounds; ++round) {
      raw_appends(file.string() + ".raw", kRound_s, raw);
      bench::run_reporters(1, kRound_s, one, report_ms);
      bench::run_reporters(16, kRound_s, sixteen, report_ms);
    }
  }
  print("durable reports, 1 client", one, {"append 8 KB + fdatasync", raw.per_s()}, 0.8);
  print("durable reports, 16 clients", sixteen, {"1 client", one.per_s()}, 2.5);
  for (const char* const suffix : {"", ".raw", ".lock", ".high-water-mark"})
    std::filesystem::remove(file.string() + suffix);
  return 0;
}

}  // namespace
}  // namespace kinship::store

int main() { return kinship::store::run(); }
