#include "client/link/backup_download.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "client/link/admin_rows.hpp"
#include "proto/files/file.hpp"
#include "proto/types/base64.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenAttempts{500};

Digest digest_of(const files::File& part) {
  std::vector<std::uint8_t> bytes(std::size_t{1} << 20U);
  Sha256 sha256;
  std::uint64_t place = 0;
  while (true) {
    const std::size_t read = part.read(reinterpret_cast<char*>(bytes.data()), bytes.size(), place);
    if (read == 0)
      return sha256.finish();
    sha256.add(std::span(bytes).first(read));
    place += read;
  }
}

/// The server's findings when it read the backup through.
struct Whole {
  Digest sha256;
  std::uint64_t bytes = 0;
};

class Downloader {
 public:
  Downloader(Client& server, const BackupDownload& download)
      : server_(server), download_(download), give_up_(Clock::now() + download.patience) {}

  /// \param part  the bytes so far; empty afterwards if they are not the server's.
  Result<DownloadedBackup> run(const files::File& part) {
    const Result<Whole> whole = ask([&] { return find_whole(); });
    if (!whole)
      return whole.error();
    std::uint64_t resumed = part.size();
    for (int i = 0; i < 2; ++i) {
      if (resumed > whole->bytes || i > 0) {  // of another backup of that name
        part.resize(0);
        resumed = 0;
      }
      if (const auto error = fetch(part, resumed, whole->bytes))
        return *error;
      if (digest_of(part) == whole->sha256)
        return DownloadedBackup{whole->bytes, resumed, whole->sha256};
      if (resumed == 0)
        break;
    }
    part.resize(0);
    return Error{ErrorCode::Internal,
                 "backup '" + download_.name + "': what came is not what the server has (SHA-256)"};
  }

 private:
  /// Asks again while no server answers, until that has lasted too long.
  template <typename Ask>
  auto ask(Ask make) -> decltype(make()) {
    while (true) {
      auto result = make();
      const auto now = Clock::now();
      if (result || result.error().code != ErrorCode::Unavailable)
        give_up_ = now + download_.patience;
      else if (now < give_up_) {
        std::this_thread::sleep_for(kBetweenAttempts);
        continue;
      }
      return result;
    }
  }

  Result<Whole> find_whole() {
    AdminRequest request;
    request.verb = AdminVerb::HashBackup;
    request.argument = download_.name;
    Result<Job> job = row_of<Job>(server_, request);
    if (!job)
      return job.error();
    const std::string id = job->id;
    job = wait_for_job(server_, id, Clock::time_point::max(), [this](const Job&) {
      if (download_.on_progress)
        download_.on_progress(0, 0);
    });
    if (!job)  // a server that was started again knows nothing of it
      return Error{
          job.error().code == ErrorCode::NotFound ? ErrorCode::Unavailable : job.error().code,
          job.error().message};
    if (job->state != JobState::Done)
      return Error{job->state == JobState::Cancelled ? ErrorCode::Unavailable : ErrorCode::Internal,
                   "job " + id + ": " + job->message};
    request.verb = AdminVerb::JobRows;
    request.argument = id;
    const Result<std::vector<std::string>> rows = rows_of(server_, request);
    if (!rows)
      return rows.error();
    return read_whole(*rows);
  }

  Result<Whole> read_whole(const std::vector<std::string>& rows) const {
    Whole whole;
    const std::optional<Digest> digest =
        rows.size() == 2 ? Digest::from_hex(rows[0]) : std::nullopt;
    const bool has_bytes =
        digest &&
        std::from_chars(rows[1].data(), rows[1].data() + rows[1].size(), whole.bytes).ec ==
            std::errc();
    if (!has_bytes)
      return Error{ErrorCode::Internal,
                   "the server did not say what backup '" + download_.name + "' is"};
    whole.sha256 = *digest;
    return whole;
  }

  std::optional<Error> fetch(const files::File& part, std::uint64_t begin, std::uint64_t end) {
    while (begin < end) {
      const Result<std::vector<std::uint8_t>> bytes = ask([&] { return read(begin); });
      if (!bytes)
        return bytes.error();
      if (bytes->empty())
        return Error{ErrorCode::Internal, "backup '" + download_.name + "': became shorter"};
      part.write({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, begin);
      begin += bytes->size();
      if (download_.on_progress)
        download_.on_progress(begin, end);
    }
    return std::nullopt;
  }

  Result<std::vector<std::uint8_t>> read(std::uint64_t begin) {
    AdminRequest request;
    request.verb = AdminVerb::ReadBackup;
    request.argument = download_.name;
    request.cursor = std::to_string(begin);
    const Result<AdminReply> reply = server_.admin(request);
    if (!reply)
      return reply.error();
    if (reply->retry_after > milliseconds(0)) {  // not its fault, and no reason to give up
      std::this_thread::sleep_for(reply->retry_after);
      give_up_ = Clock::now() + download_.patience;
      return Error{ErrorCode::Unavailable, reply->message};
    }
    if (reply->status != AdminStatus::Ok)
      return Error{
          reply->status == AdminStatus::NotFound ? ErrorCode::NotFound : ErrorCode::Internal,
          reply->message};
    if (reply->rows.empty())
      return std::vector<std::uint8_t>();
    std::optional<std::vector<std::uint8_t>> bytes = from_base64(reply->rows.front());
    if (!bytes || reply->last_row_continues)
      return Error{ErrorCode::Internal, "backup '" + download_.name + "': unreadable page"};
    return *std::move(bytes);
  }

  Client& server_;
  const BackupDownload& download_;
  Clock::time_point give_up_;
};

}  // namespace

Result<DownloadedBackup> download_backup(Client& server, const BackupDownload& download) {
  const auto taken = [&](const std::string& why) {
    return Error{ErrorCode::Conflict, "file '" + download.file.string() + "': " + why};
  };
  std::error_code error;
  if (fs::exists(fs::symlink_status(download.file, error)))
    return taken("is there already");
  constexpr mode_t kOwnerOnly = 0600;  // it holds all that the server knows
  const std::string name = download.file.string() + ".part";
  const files::File part(name, O_RDWR | O_CREAT | O_NOFOLLOW, kOwnerOnly);
  if (!part.try_lock())
    return taken("another process is fetching it");
  Result<DownloadedBackup> downloaded = Downloader(server, download).run(part);
  if (!downloaded) {
    if (part.size() == 0)
      fs::remove(name, error);
    return downloaded.error();
  }
  part.sync();
  const int reason = files::rename_new(name, download.file);
  if (reason == EEXIST)
    return taken("is there already; what came is in '" + name + "'");
  if (reason != 0)
    throw Failure(ErrorCode::Storage, "file '" + name + "': cannot be named '" +
                                          download.file.string() +
                                          "': " + std::generic_category().message(reason));
  return downloaded;
}

}  // namespace kinship::link
