#include "tests/faults/store_ledger.hpp"

#include <algorithm>
#include <exception>
#include <fstream>
#include <map>
#include <optional>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "tests/golden/golden_store.hpp"
#include "tests/support/next_schema.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {
namespace {

using store::RobotRecord;
using store::Store;
using store::StoredPath;

constexpr const char* kTask = "stack";  // no task of the golden store
constexpr std::uint64_t kFirstNumber = 1000;

Attempt make_ledger_attempt(std::uint64_t number) {
  const Digest& robot = ledger_robots()[number % 2].digest;
  Attempt attempt = number % 5 == 4 ? make_unsolved(robot, kTask, kFirstNumber + number)
                                    : make_attempt(robot, kTask, kFirstNumber + number);
  if (attempt.path && number % 7 == 0)
    attempt.path = make_path(kFirstNumber + number, kDof, 600);
  const double height_m = 0.5 + 0.001 * static_cast<double>(number % 10);
  if (number % 3 == 0)
    attempt.scene = RecordedScene{{{"table", BoxShape{{1, 2, height_m}}}}, {}, {}};
  return attempt;
}

bool is_equal(const Attempt& found, const Attempt& wanted) {
  return found.robot == wanted.robot && found.task == wanted.task &&
         found.machine == wanted.machine && found.record.outcome == wanted.record.outcome &&
         found.record.collision_checks == wanted.record.collision_checks &&
         found.path.has_value() == wanted.path.has_value() &&
         (!wanted.path || found.path->waypoints() == wanted.path->waypoints()) &&
         found.scene.has_value() == wanted.scene.has_value() &&
         (!wanted.scene || content_digest(*found.scene) == content_digest(*wanted.scene));
}

std::string find_lost_attempts(const Store& store, const Receipts& receipts) {
  for (const std::uint64_t number : receipts.reports) {
    const Attempt& wanted = ledger_attempt(number);
    const std::optional<Attempt> found = store.find_attempt(wanted.report_uuid);
    if (!found)
      return "report " + std::to_string(number) + " is lost";
    if (!is_equal(*found, wanted))
      return "report " + std::to_string(number) + " is not as it was";
  }
  if (receipts.golden)
    for (const Attempt& wanted : golden_attempts()) {
      const std::optional<Attempt> found = store.find_attempt(wanted.report_uuid);
      if (!found || !is_equal(*found, wanted))
        return "an attempt of the golden store is lost";
    }
  return "";
}

/// Paths as a fit reads them: each once, whole, and those that were acknowledged are among them.
std::string find_wrong_paths(const Store& store, const Receipts& receipts) {
  std::map<Uuid, int> times;
  for (const RobotRecord& robot : ledger_robots())
    for (const StoredPath& path :
         store.read_paths(robot.digest, kTask, {.after_id = 0, .limit = 100'000}))
      ++times[path.report_uuid];
  for (const auto& [uuid, count] : times)
    if (count > 1)
      return "a path is there twice";
  for (const std::uint64_t number : receipts.reports) {
    const Attempt& wanted = ledger_attempt(number);
    if (wanted.path && !receipts.retired.contains(number) && !times.contains(wanted.report_uuid))
      return "the path of report " + std::to_string(number) + " cannot be read";
  }
  return "";
}

std::string find_lost_others(const Store& store, const Receipts& receipts) {
  for (const std::string& label : receipts.robots) {
    const auto& robots = ledger_robots();
    const auto robot = std::find_if(robots.begin(), robots.end(), [&](const RobotRecord& record) {
      return record.description.label == label;
    });
    if (!store.find_robot(robot->digest))
      return "robot " + label + " is lost";
  }
  for (const std::uint64_t number : receipts.distributions)
    if (!store.find_distribution(id_from<Digest>(number)))
      return "distribution " + std::to_string(number) + " is lost";
  return "";
}

/// What a client does that lost the receipt: it must not be stored once more.
std::string find_wrong_answers(Store& store, const Receipts& receipts) {
  constexpr std::size_t kResent = 3;
  const std::uint64_t before = store.status().attempts;
  std::vector<Attempt> again;
  for (auto number = receipts.reports.rbegin();
       number != receipts.reports.rend() && again.size() < kResent; ++number)
    again.push_back(ledger_attempt(*number));
  std::vector<Receipt> answers = report(store, again);
  const auto waits = [](const Receipt& receipt) {
    return receipt.status == ReceiptStatus::TryAgain;
  };
  constexpr int kPatience = 10'000;  // the store may be about to open again
  for (int tries = 0; tries < kPatience && std::any_of(answers.begin(), answers.end(), waits);
       ++tries)
    answers = report(store, again);
  for (const Receipt& receipt : answers)
    if (receipt.status != ReceiptStatus::Duplicate)
      return "a report is answered " + std::to_string(static_cast<int>(receipt.status)) +
             " when it comes again: " + receipt.message;
  if (store.status().attempts != before)
    return "a report that came again is stored again";
  return "";
}

/// The store goes on after the cut.
std::string find_refusal(Store& store) {
  constexpr std::uint64_t kNew = 900'000;
  for (const RobotRecord& robot : ledger_robots())
    static_cast<void>(store.register_robot(robot));
  const Receipt receipt = report(store, {ledger_attempt(kNew)}).at(0);
  return receipt.status == ReceiptStatus::Stored || receipt.status == ReceiptStatus::Recorded
             ? ""
             : "takes no report: " + receipt.message;
}

std::string find_damage(const std::filesystem::path& file) {
  const StoreCheck check = store::check_store(file, [](double) {});
  if (check.problems == 0 && check.damaged_paths == 0)
    return "";
  return "the check finds " + (check.messages.empty() ? "damage" : check.messages.front());
}

void lay(const DiskImage& image, const std::filesystem::path& directory) {
  for (const auto& [name, bytes] : image)
    std::ofstream(directory / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

/// A copy is whole or not there; one that was acknowledged is there.
std::string find_bad_copy(const DiskImage& image, const Receipts& receipts,
                          const std::filesystem::path& directory) {
  for (const std::string& name : receipts.backups)
    if (!image.contains(name))
      return "backup " + name + " is lost";
  for (const auto& [name, bytes] : image)
    if (name.starts_with("copy-") && name.ends_with(".db"))
      if (const std::string damage = find_damage(directory / name); !damage.empty())
        return "backup " + name + ": " + damage;
  return "";
}

}  // namespace

const std::vector<RobotRecord>& ledger_robots() {
  static const std::vector<RobotRecord> kRobots = {make_robot("ur5e", 501),
                                                   make_robot("gen3", 502)};
  return kRobots;
}

const Attempt& ledger_attempt(std::uint64_t number) {
  static std::mutex mutex;
  static std::map<std::uint64_t, Attempt> attempts;
  const std::lock_guard lock(mutex);
  auto found = attempts.find(number);
  if (found == attempts.end())
    found = attempts.emplace(number, make_ledger_attempt(number)).first;
  return found->second;
}

std::size_t report_until_answered(Store& store, Ledger& ledger,
                                  const std::vector<std::uint64_t>& numbers, int patience) {
  std::map<Uuid, std::uint64_t> waiting;
  for (const std::uint64_t number : numbers)
    waiting[ledger_attempt(number).report_uuid] = number;
  for (int again = 0; again < patience && !waiting.empty(); ++again) {
    std::vector<Attempt> attempts;
    for (const auto& [uuid, number] : waiting)
      attempts.push_back(ledger_attempt(number));
    const std::vector<Receipt> receipts = report(store, std::move(attempts));
    ledger.note([&](Receipts& noted) {
      for (const Receipt& receipt : receipts)
        if (receipt.status != ReceiptStatus::TryAgain && receipt.status != ReceiptStatus::Refused)
          noted.reports.insert(waiting.at(receipt.report_uuid));
    });
    for (const Receipt& receipt : receipts)
      if (receipt.status != ReceiptStatus::TryAgain && receipt.status != ReceiptStatus::Refused)
        waiting.erase(receipt.report_uuid);
  }
  return waiting.size();
}

std::string find_loss(Store& store, const Receipts& receipts) {
  for (const auto& find : {find_lost_attempts, find_wrong_paths, find_lost_others})
    if (std::string wrong = find(store, receipts); !wrong.empty())
      return wrong;
  return find_wrong_answers(store, receipts);
}

std::string find_loss(const DiskImage& image, const Receipts& receipts) {
  const TemporaryDirectory directory;
  lay(image, directory.path());
  try {
    if (std::string wrong = find_bad_copy(image, receipts, directory.path()); !wrong.empty())
      return wrong;
    if (receipts.golden) {  // the program that migrates it goes on where it was
      store::make_wal_durable(directory / kStoreName);
      store::open_migrated(directory / kStoreName, with_next_schema());
      undo_next_schema(directory / kStoreName);
    }
    {
      const std::unique_ptr<Store> store = store::open_sqlite_store(directory / kStoreName);
      if (std::string wrong = find_loss(*store, receipts); !wrong.empty())
        return wrong;
      if (std::string wrong = find_refusal(*store); !wrong.empty())
        return wrong;
    }
    return find_damage(directory / kStoreName);
  } catch (const std::exception& failure) {
    return failure.what();
  }
}

}  // namespace kinship::test
