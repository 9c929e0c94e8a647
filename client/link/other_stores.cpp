#include "client/link/other_stores.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "client/link/durable_file.hpp"
#include "client/link/outbox_files.hpp"
#include "client/link/sent_reports.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/store_epoch.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kKeptIn[] = {kSentBefore, kSent, kPending};

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// Calls `visit` with the file of each report that a folder of a store keeps.
void for_each_kept(const fs::path& store, const std::function<void(const fs::path&)>& visit) {
  for (const std::string_view part : kKeptIn)
    if (is_there(store / part))
      for_each_entry(store / part, [&](const fs::directory_entry& entry) {
        if (report_uuid_of(entry.path()))
          visit(entry.path());
      });
}

std::size_t count_kept(const fs::path& store) {
  std::size_t count = 0;
  for_each_kept(store, [&](const fs::path&) { ++count; });
  return count;
}

void delete_all(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error)
    throw Failure(ErrorCode::Storage, path.string() + ": cannot be deleted: " + error.message());
}

/// Its epoch last: ended before, what is left is listed.
void remove_store(const fs::path& store) {
  if (!is_there(store))
    return;
  for_each_entry(store, [](const fs::directory_entry& entry) {
    if (entry.path().filename() != kEpoch)
      delete_all(entry.path());
  });
  delete_all(store);
}

}  // namespace

OtherStores::OtherStores(fs::path outbox) : outbox_(std::move(outbox)) {}

fs::path OtherStores::folder_of(const Uuid& epoch) const {
  return outbox_ / kFolder / store_name(epoch);
}

std::vector<fs::path> OtherStores::folders() const {
  std::vector<fs::path> folders;
  if (is_there(outbox_ / kFolder))
    for_each_entry(outbox_ / kFolder, [&](const fs::directory_entry& entry) {
      if (is_there(entry.path() / kEpoch))
        folders.push_back(entry.path());
    });
  return folders;
}

void OtherStores::put_away(const Uuid& epoch) const {
  const fs::path folder = folder_of(epoch);
  make_folder_durably(outbox_ / kFolder);
  make_folder_durably(folder);
  write_durably(folder / kEpoch, epoch.text() + "\n");
  move_file(outbox_ / kToken, folder / kToken);
  const SentReports there(folder);
  SentReports(outbox_).for_each([&](const fs::path& report) {
    move_file(report, there.file(report_uuid_of(report).value_or(Uuid{})));
  });
}

void OtherStores::hold_back(const Uuid& epoch, const std::set<Uuid>& reports) const {
  const fs::path held = folder_of(epoch) / kPending;
  make_folder_durably(held);
  for (const Uuid& report : reports)
    move_file(outbox_ / kPending / report_file_name(report), held / report_file_name(report));
}

std::optional<Uuid> OtherStores::known_epoch(const Uuid& epoch) const {
  return noted_epoch(folder_of(epoch));
}

void OtherStores::bring_back(const Uuid& epoch) const {
  const fs::path folder = folder_of(epoch);
  if (!is_there(folder))
    return;
  move_file(folder / kToken, outbox_ / kToken);
  for_each_kept(folder, [&](const fs::path& report) {
    move_file(report, outbox_ / report.parent_path().filename() / report.filename());
  });
}

std::size_t OtherStores::offer_again() const {
  std::size_t offered = 0;
  for (const fs::path& folder : folders())
    for_each_kept(folder, [&](const fs::path& report) {
      offered += move_file(report, outbox_ / kPending / report.filename()) ? 1U : 0U;
    });
  return offered;
}

std::size_t OtherStores::drop(const std::vector<KeptReports>& stores) const {
  std::size_t dropped = 0;
  for (const KeptReports& each : stores) {
    const fs::path folder = outbox_ / kFolder / each.store;
    dropped += count_kept(folder);
    remove_store(folder);
  }
  return dropped;
}

std::vector<KeptReports> OtherStores::kept() const {
  std::vector<KeptReports> kept;
  for (const fs::path& folder : folders())
    if (const std::size_t reports = count_kept(folder); reports > 0)
      kept.push_back({folder.filename().string(), reports});
  return kept;
}

void OtherStores::age(std::chrono::milliseconds sending) const {
  for (const fs::path& folder : folders())
    SentReports(folder).age(sending);
  for (const fs::path& folder : folders())
    if (count_kept(folder) == 0)
      remove_store(folder);
}

}  // namespace kinship::link
