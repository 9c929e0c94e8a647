#include "tests/faults/store_session.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace kinship::test {
namespace {

const std::filesystem::path& with_golden(const std::filesystem::path& directory,
                                         const std::filesystem::path& golden) {
  if (!golden.empty())
    std::filesystem::copy_file(golden, directory / kStoreName);
  return directory;
}

}  // namespace

StoreSession::StoreSession(std::uint64_t seed, std::uint64_t mean_gap,
                           const std::filesystem::path& golden)
    : generator_(seed), mean_gap_(mean_gap), disk_(with_golden(directory_.path(), golden), seed) {
  ledger_.note([&](Receipts& noted) { noted.golden = !golden.empty(); });
  next_cut_ = generator_() % (2 * mean_gap_);
  disk_.on_change([this](std::uint64_t change) { before_change(change); });
}

void StoreSession::cut_every(std::uint64_t mean_gap) {
  mean_gap_ = mean_gap;
  next_cut_ = disk_.changes();
}

void StoreSession::before_change(std::uint64_t change) {
  constexpr std::uint64_t kLongAfter = 100;
  if (const std::uint64_t failed = disk_.failed(); failed != failed_) {
    failed_ = failed;
    dense_until_ = is_eager_ ? change + kLongAfter : 0;
    next_cut_ = is_eager_ ? change : next_cut_;
  }
  if (change >= next_cut_)
    cut(change);
}

void StoreSession::cut(std::uint64_t change) {
  cuts_.push_back({change, disk_.image(), ledger_.receipts()});
  constexpr std::uint64_t kDenseGap = 4;
  const std::uint64_t gap = change < dense_until_ ? std::min(kDenseGap, mean_gap_) : mean_gap_;
  next_cut_ = change + 1 + generator_() % (2 * gap);
}

store::SqliteOptions StoreSession::small_options() {
  store::SqliteOptions options;
  options.retry_after = std::chrono::milliseconds(1);
  options.checkpoint_bytes = 250'000;
  return options;
}

std::unique_ptr<store::Store> StoreSession::open(const store::SqliteOptions& options) const {
  return store::open_sqlite_store(file(), options);
}

void StoreSession::register_robots(store::Store& store) {
  for (const store::RobotRecord& robot : ledger_robots()) {
    if (!store.register_robot(robot))
      throw std::runtime_error("a robot is refused");
    ledger_.note([&](Receipts& noted) { noted.robots.insert(robot.description.label); });
  }
}

std::unique_ptr<store::Store> StoreSession::open_with_robots() {
  std::unique_ptr<store::Store> store = open();
  register_robots(*store);
  return store;
}

void StoreSession::report(store::Store& store, std::uint64_t clients,
                          std::uint64_t attempts_of_each) {
  std::atomic<bool> refused = false;
  std::vector<std::thread> threads;
  for (std::uint64_t client = 0; client < clients; ++client) {
    const std::uint64_t end = next_number_ + attempts_of_each;
    threads.emplace_back([&, first = next_number_, end] {
      for (std::uint64_t number = first; number < end;) {
        std::vector<std::uint64_t> batch;
        for (std::uint64_t size = 1 + number % 3; size > 0 && number < end; --size)
          batch.push_back(number++);
        if (report_until_answered(store, ledger_, batch) > 0)
          refused = true;
      }
    });
    next_number_ = end;
  }
  for (std::thread& thread : threads)
    thread.join();
  if (refused)
    throw std::runtime_error("a report is refused");
}

void StoreSession::retire(store::Store& store, std::uint64_t number) {
  ledger_.note([&](Receipts& noted) { noted.retired.insert(number); });
  if (!store.retire_path(ledger_attempt(number).report_uuid))
    throw std::runtime_error("a path is not retired");
}

void StoreSession::put_distribution(store::Store& store, std::uint64_t number) {
  store.put_distribution(make_distribution(ledger_robots()[0].digest, "stack", number));
  ledger_.note([&](Receipts& noted) { noted.distributions.insert(number); });
}

std::vector<std::string> StoreSession::find_losses() {
  disk_.on_change({});
  cut(disk_.changes());
  std::vector<std::string> losses;
  for (const PowerCut& one : cuts_)
    if (const std::string loss = find_loss(one.image, one.receipts); !loss.empty())
      losses.push_back("cut before change " + std::to_string(one.change) + ": " + loss);
  looked_at_ += cuts_.size();
  cuts_.clear();
  return losses;
}

}  // namespace kinship::test
