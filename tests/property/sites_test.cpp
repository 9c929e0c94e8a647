#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "server/sites/exchange.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/troubled_store.hpp"

/// Two sites and the memory above them: random reports, retirements, lines that are cut at any
/// call, servers that end at any time and stores that are put back to a backup. When all lines hold
/// again, all three have the same reports, the same of them retired, and the same paths in use.
namespace kinship::sites {
namespace {

constexpr std::uint64_t kContents = 6;
const std::vector<std::string> kTasks = {"shelf", "table"};

struct LineCut {};

/// A store and what is connected with it.
struct Place {
  std::filesystem::path file;
  std::unique_ptr<store::Store> store;
  // Of a site:
  std::unique_ptr<store::TroubledStore> line;
  std::optional<Positions> positions;
  std::optional<Exchange> exchange;
  ExchangeCounts counts;

  void disconnect() {
    exchange.reset();
    positions.reset();
    line.reset();
  }
};

class World {
 public:
  explicit World(std::uint64_t seed) : generator_(seed) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      places_[i].file = directory_.path() / ("store" + std::to_string(i) + ".db");
      open(i);
      // Equal labels of different robots, as sites have them.
      robots_[i] = test::make_robot("arm", i + 1);
      EXPECT_TRUE(places_[i].store->register_robot(robots_[i]));
      static_cast<void>(places_[i].store->register_robot(shared_robot_));
    }
  }

  /// \param may_put_back  stores may be put back to a backup.
  void run(int events, bool may_put_back) {
    for (int i = 0; i < events; ++i)
      switch (pick(may_put_back ? 12 : 11)) {
        case 0:
        case 1:
        case 2:
        case 3:
          report(pick(places_.size()));
          break;
        case 4:
        case 5:
          retire(pick(places_.size()));
          break;
        case 6:
        case 7:
        case 8:
          talk(1 + pick(2));
          break;
        case 9:
          restart(pick(places_.size()));
          break;
        case 10:
          places_[1 + pick(2)].disconnect();
          break;
        default:
          pick(2) == 0 ? back_up(pick(places_.size())) : put_back(pick(places_.size()));
      }
  }

  /// Until nobody has anything to tell.
  void talk_it_out() {
    for (int round = 0; round < 3; ++round)
      for (const std::size_t site : {1U, 2U, 1U})
        for (int idle = 0; idle < 8;)
          idle = connected(site, -1).step().has_worked ? 0 : idle + 1;
  }

  std::set<Uuid> reports(std::size_t place) const {
    std::set<Uuid> reports;
    std::size_t rows = 0;
    for (const store::ArrivedReport& report : arrivals(place)) {
      reports.insert(report.report_uuid);
      ++rows;
    }
    EXPECT_EQ(rows, reports.size()) << "something is there twice";
    EXPECT_EQ(rows, places_[place].store->status().attempts);
    return reports;
  }
  std::set<Uuid> retired(std::size_t place) const {
    std::set<Uuid> retired;
    for (const store::ArrivedReport& report : arrivals(place))
      if (report.is_retired)
        retired.insert(report.report_uuid);
    return retired;
  }
  /// Contents that fits read, by robot and task.
  std::map<std::pair<Digest, std::string>, std::multiset<double>> in_use(std::size_t place) const {
    std::map<std::pair<Digest, std::string>, std::multiset<double>> contents;
    for (const store::RobotRecord& robot : places_[place].store->robots())
      for (const std::string& task : kTasks)
        for (const store::StoredPath& path :
             places_[place].store->read_paths(robot.digest, task, {.after_id = 0, .limit = 1000}))
          contents[{robot.digest, task}].insert(path.path.waypoints()(0, 0));
    return contents;
  }

  std::set<Uuid> acknowledged, acknowledged_retired;

 private:
  std::uint64_t pick(std::uint64_t below) {
    return std::uniform_int_distribution<std::uint64_t>(0, below - 1)(generator_);
  }
  std::vector<store::ArrivedReport> arrivals(std::size_t place) const {
    return places_[place].store->list_arrivals("", "", 100'000).rows;
  }
  void open(std::size_t place) {
    places_[place].store = store::open_sqlite_store(places_[place].file);
  }
  void close(std::size_t place) {
    // Who talks with the memory cannot any more.
    for (std::size_t i = 1; i < places_.size(); ++i)
      if (place == 0 || place == i)
        places_[i].disconnect();
    places_[place].store.reset();
  }
  void restart(std::size_t place) {
    close(place);
    open(place);
  }

  void report(std::size_t place) {
    const Digest robot = pick(2) == 0 ? shared_robot_.digest : robots_[place].digest;
    Attempt attempt = test::make_attempt(robot, kTasks[pick(2)], ++number_);
    if (pick(4) == 0) {
      attempt.record.outcome = Outcome::Failed;
      attempt.path.reset();
    } else {
      attempt.path = test::make_path(pick(kContents));
    }
    const ReceiptStatus status = test::report(*places_[place].store, {attempt}).at(0).status;
    EXPECT_NE(status, ReceiptStatus::Refused);
    EXPECT_NE(status, ReceiptStatus::TryAgain);
    acknowledged.insert(attempt.report_uuid);
  }

  void retire(std::size_t place) {
    if (pick(8) == 0) {
      const std::string& task = kTasks[pick(2)];
      for (const store::ArrivedReport& report :
           places_[place].store->list_arrivals(task, "", 10'000).rows)
        if (places_[place].store->find_attempt(report.report_uuid)->path)
          acknowledged_retired.insert(report.report_uuid);
      static_cast<void>(places_[place].store->reset_task(task));
      return;
    }
    const std::vector<store::ArrivedReport> known = arrivals(place);
    if (known.empty())
      return;
    const Uuid report = known[pick(known.size())].report_uuid;
    if (places_[place].store->retire_path(report))
      acknowledged_retired.insert(report);
  }

  /// \param calls  after so many the line is cut; negative: it holds.
  Exchange& connected(std::size_t site, int calls) {
    Place& place = places_[site];
    calls_ = calls;
    if (place.exchange)
      return *place.exchange;
    place.line = std::make_unique<store::TroubledStore>(*places_[0].store);
    place.line->on_exchange = [this] {
      if (calls_ >= 0 && calls_-- == 0)
        throw LineCut();
    };
    ExchangeOptions options;
    options.look_every = std::chrono::milliseconds(0);
    options.up = {.reports = 5, .commit = 3, .bytes = 2000, .retirements = 2};
    options.down = {.reports = 4, .commit = 2, .bytes = 2000, .retirements = 3};
    SiteHooks hooks;
    hooks.tasks_in_use = [] { return std::set<std::string>(kTasks.begin(), kTasks.end()); };
    place.positions.emplace(*place.store);
    place.exchange.emplace(*place.store, *place.line, *place.positions, place.counts, hooks,
                           options);
    return *place.exchange;
  }

  void talk(std::size_t site) {
    const auto steps = 1 + pick(6);
    const int calls = pick(2) == 0 ? -1 : static_cast<int>(pick(25));
    try {
      for (std::uint64_t i = 0; i < steps; ++i)
        connected(site, i == 0 ? calls : calls_).step();
    } catch (const LineCut&) {
      places_[site].disconnect();
    }
  }

  void back_up(std::size_t place) {
    const std::filesystem::path copy = copy_of(place);
    std::filesystem::remove(copy);
    EXPECT_TRUE(places_[place].store->backup(copy, [](double) { return true; }).value());
  }
  /// What nobody else has is lost then.
  void put_back(std::size_t place) {
    if (!std::filesystem::exists(copy_of(place)))
      return;
    close(place);
    store::restore_store(copy_of(place), places_[place].file, [](double) {});
    open(place);
  }
  std::filesystem::path copy_of(std::size_t place) const {
    return places_[place].file.string() + ".copy";
  }

  const test::TemporaryDirectory directory_;
  std::mt19937_64 generator_;
  std::array<Place, 3> places_;  // 0: the memory
  std::array<store::RobotRecord, 3> robots_;
  const store::RobotRecord shared_robot_ = test::make_robot("same everywhere", 10);
  std::uint64_t number_ = 0;
  int calls_ = -1;
};

class Sites : public testing::TestWithParam<std::uint64_t> {};

void expect_one_memory(const World& world, const std::set<Uuid>& reports) {
  const std::set<Uuid> retired = world.retired(0);
  const auto in_use = world.in_use(0);
  for (const std::size_t place : {0U, 1U, 2U}) {
    EXPECT_EQ(world.reports(place), reports) << "store " << place;
    EXPECT_EQ(world.retired(place), retired) << "store " << place;
    EXPECT_EQ(world.in_use(place), in_use) << "store " << place;
  }
}

TEST_P(Sites, HaveTheSameInTheEndWhateverHappenedOnTheWay) {
  World world(GetParam());
  world.run(120, false);
  world.talk_it_out();
  expect_one_memory(world, world.acknowledged);
  for (const Uuid& report : world.acknowledged_retired)
    EXPECT_TRUE(world.retired(0).contains(report)) << report.text();
}

TEST_P(Sites, LoseNothingThatOneOfThemHasWhenOthersArePutBack) {
  World world(GetParam() + 100);
  world.run(120, true);
  std::set<Uuid> there;
  for (const std::size_t place : {0U, 1U, 2U})
    there.merge(world.reports(place));
  std::set<Uuid> retired;
  for (const std::size_t place : {0U, 1U, 2U})
    retired.merge(world.retired(place));
  world.talk_it_out();
  expect_one_memory(world, there);
  for (const Uuid& report : retired)
    EXPECT_TRUE(world.retired(0).contains(report)) << report.text();
}

INSTANTIATE_TEST_SUITE_P(Seed, Sites, testing::Values(1, 2, 3));

}  // namespace
}  // namespace kinship::sites
