#include "client/link/outbox_files.hpp"

#include <system_error>

#include "client/link/durable_file.hpp"
#include "proto/files/lock_file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kReportSuffix = ".json";
constexpr const char* kSenderLock = "sender.lock";

void require_done(const std::error_code& error, const fs::path& path, const char* what) {
  if (error)
    throw Failure(ErrorCode::Storage, path.string() + ": " + what + ": " + error.message());
}

}  // namespace

std::optional<Uuid> noted_epoch(const fs::path& folder) {
  constexpr std::size_t kUuidTextBytes = 36;
  std::error_code error;
  if (!fs::exists(folder / kEpoch, error))
    return std::nullopt;
  return Uuid::parse(read_file(folder / kEpoch, 1024).substr(0, kUuidTextBytes));
}

std::optional<files::LockFile> try_to_become_sender(const fs::path& outbox) {
  try {
    return files::LockFile::try_acquire(outbox / kSenderLock, 0644);
  } catch (const files::FileError& error) {
    fail_on(error);
  }
}

std::string sender_of(const fs::path& outbox) {
  return files::LockFile::holder(outbox / kSenderLock);
}

std::string report_file_name(const Uuid& report_uuid) {
  return report_uuid.text().append(kReportSuffix);
}

std::optional<Uuid> report_uuid_of(const fs::path& path) {
  const std::string name = path.filename().string();
  if (!name.ends_with(kReportSuffix))
    return std::nullopt;
  return Uuid::parse(std::string_view(name).substr(0, name.size() - kReportSuffix.size()));
}

void for_each_entry(const fs::path& folder,
                    const std::function<void(const fs::directory_entry&)>& visit) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    visit(*entry);
  require_done(error, folder, "cannot list");
}

bool move_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error == std::errc::no_such_file_or_directory)
    return false;
  require_done(error, to, "cannot rename to");
  return true;
}

}  // namespace kinship::link
