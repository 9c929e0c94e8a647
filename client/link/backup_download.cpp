#include "client/link/backup_download.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "client/link/admin_rows.hpp"
#include "proto/types/base64.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenAttempts{500};

/// What has arrived so far, for one process at a time.
class PartFile {
 public:
  explicit PartFile(fs::path file) : file_(std::move(file)), part_(file_.string() + ".part") {
    constexpr mode_t kOwnerOnly = 0600;  // it holds all that the server knows
    descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kOwnerOnly);
    if (descriptor_ < 0)
      fail("cannot be opened");
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile() { close(descriptor_); }

  bool lock() const { return flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }

  std::uint64_t size() const {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0)
      fail("cannot be read");
    return static_cast<std::uint64_t>(status.st_size);
  }
  void clear() const {
    if (ftruncate(descriptor_, 0) != 0)
      fail("cannot be written");
  }
  void write(const std::vector<std::uint8_t>& bytes, std::uint64_t begin) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t written = pwrite(descriptor_, bytes.data() + done, bytes.size() - done,
                                     static_cast<off_t>(begin + done));
      if (written < 0 && errno != EINTR)
        fail("cannot be written");
      done += written > 0 ? static_cast<std::size_t>(written) : 0;
    }
  }
  Digest digest() const {
    constexpr std::size_t kStep = std::size_t{1} << 20U;
    std::vector<std::uint8_t> bytes(kStep);
    Sha256 sha256;
    for (off_t place = 0;;) {
      const ssize_t read = pread(descriptor_, bytes.data(), bytes.size(), place);
      if (read < 0 && errno != EINTR)
        fail("cannot be read");
      if (read == 0)
        return sha256.finish();
      if (read < 0)
        continue;
      sha256.add(std::span<const std::uint8_t>(bytes.data(), static_cast<std::size_t>(read)));
      place += read;
    }
  }

  /// Gives the file its name. \return false if that is taken.
  bool publish() const {
    if (fsync(descriptor_) != 0)
      fail("cannot be written");
    int error = renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, file_.c_str(), RENAME_NOREPLACE) == 0
                    ? 0
                    : errno;
    if (error == EINVAL || error == ENOSYS)  // not every file system can do that
      error = ::link(part_.c_str(), file_.c_str()) == 0 && unlink(part_.c_str()) == 0 ? 0 : errno;
    errno = error;
    if (error != 0 && error != EEXIST)
      fail("cannot be named '" + file_.string() + "'");
    return error == 0;
  }
  void remove() const { unlink(part_.c_str()); }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(ErrorCode::Storage, "file '" + part_.string() + "': " + what + ": " +
                                          std::generic_category().message(errno));
  }

  fs::path file_, part_;
  int descriptor_ = -1;
};

/// What the server found when it read the backup through.
struct Whole {
  Digest sha256;
  std::uint64_t bytes = 0;
};

class Downloader {
 public:
  Downloader(Client& server, const BackupDownload& download)
      : server_(server), download_(download), give_up_(Clock::now() + download.patience) {}

  Result<DownloadedBackup> run(const PartFile& part) {
    const Result<Whole> whole = ask([&] { return find_whole(); });
    if (!whole)
      return whole.error();
    std::uint64_t resumed = part.size();
    for (int i = 0; i < 2; ++i) {
      if (resumed > whole->bytes || i > 0) {  // of another backup of that name
        part.clear();
        resumed = 0;
      }
      if (const auto error = fetch(part, resumed, whole->bytes))
        return *error;
      if (part.digest() == whole->sha256)
        return DownloadedBackup{whole->bytes, resumed, whole->sha256};
      if (resumed == 0)
        break;
    }
    part.remove();
    return Error{ErrorCode::Internal,
                 "backup '" + download_.name + "': what came is not what the server has (SHA-256)"};
  }

 private:
  /// Asks again while nobody answers, until that has lasted too long.
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
    Result<Job> job = job_of(server_, request);
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

  std::optional<Error> fetch(const PartFile& part, std::uint64_t begin, std::uint64_t end) {
    while (begin < end) {
      const Result<std::vector<std::uint8_t>> bytes = ask([&] { return read(begin); });
      if (!bytes)
        return bytes.error();
      if (bytes->empty())
        return Error{ErrorCode::Internal, "backup '" + download_.name + "': became shorter"};
      part.write(*bytes, begin);
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
  const PartFile part(download.file);
  if (!part.lock())
    return taken("another process is fetching it");
  Result<DownloadedBackup> downloaded = Downloader(server, download).run(part);
  if (!downloaded) {
    if (part.size() == 0)
      part.remove();
    return downloaded.error();
  }
  if (!part.publish())
    return taken("is there already; what came is in '" + download.file.string() + ".part'");
  return downloaded;
}

}  // namespace kinship::link
