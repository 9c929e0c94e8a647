#include "client/link/sent_reports.hpp"

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "client/link/durable_file.hpp"
#include "client/link/outbox_files.hpp"
#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr const char* kAge = "sent_age_ms";
constexpr milliseconds kMaxAge = std::chrono::hours(7 * 24);
constexpr std::size_t kMaxReports = 250'000;

/// 0 if the file is missing or damaged: then everything is kept longer.
milliseconds read_age(const fs::path& file) {
  std::int64_t age_ms = 0;
  try {
    const std::string text = read_file(file, 64);
    std::from_chars(text.data(), text.data() + text.size(), age_ms);
  } catch (const Failure&) {
    return milliseconds(0);
  }
  return milliseconds(age_ms);
}

std::size_t count_entries(const fs::path& folder) {
  std::size_t count = 0;
  for_each_entry(folder, [&](const fs::directory_entry&) { ++count; });
  return count;
}

}  // namespace

SentReports::SentReports(fs::path outbox) : outbox_(std::move(outbox)) { make_folders(); }

void SentReports::make_folders() const {
  for (const std::string_view folder : {kSent, kSentBefore})
    make_folder_durably(outbox_ / folder);
}

fs::path SentReports::file(const Uuid& report_uuid) const {
  return outbox_ / kSent / report_file_name(report_uuid);
}

void SentReports::for_each(const std::function<void(const fs::path&)>& visit) const {
  for (const std::string_view folder : {kSentBefore, kSent})
    for_each_entry(outbox_ / folder, [&](const fs::directory_entry& entry) {
      if (report_uuid_of(entry.path()))
        visit(entry.path());
    });
}

void SentReports::age(milliseconds sending) const {
  const milliseconds age = read_age(outbox_ / kAge) + sending;
  if (age >= kMaxAge || count_entries(outbox_ / kSent) >= kMaxReports)
    return rotate();
  if (sending.count() > 0)
    write_whole(outbox_ / kAge, std::to_string(age.count()) + "\n");
}

/// Ended at any point it leaves the reports of sent/ in one of the two folders for seven days more.
void SentReports::rotate() const {
  write_durably(outbox_ / kAge, "0\n");
  std::error_code error;
  fs::remove_all(outbox_ / kSentBefore, error);
  if (!error)
    move_file(outbox_ / kSent, outbox_ / kSentBefore);
  make_folders();
}

}  // namespace kinship::link
