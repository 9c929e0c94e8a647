#include "server/store/sqlite/upkeep/content_watch.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kPatrol_bytes_per_s = std::uint64_t{32} << 20U;

/// Of pages that are spread over the file, all of a small one, with its length.
std::uint32_t checksum_of_sample(const files::File& file, std::uint64_t page_bytes) {
  constexpr std::uint64_t kPages = 64;
  const std::uint64_t pages = file.size() / page_bytes;
  const std::uint64_t sampled = std::min(pages, kPages);
  std::vector<std::uint8_t> page(page_bytes);
  auto checksum = static_cast<std::uint32_t>(pages);
  for (std::uint64_t i = 0; i < sampled; ++i) {
    const std::uint64_t number = sampled < kPages ? i : i * (pages - 1) / (kPages - 1);
    page.resize(file.read(reinterpret_cast<char*>(page.data()), page_bytes, number * page_bytes));
    checksum = crc32c(page, checksum);
    page.resize(page_bytes);
  }
  return checksum;
}

/// Whether a checkpoint may have written to the database file.
bool may_be_moving(const WalIndex& before, const WalIndex& after) {
  return !before.has_same_moves(after) || after.moving > after.moved;
}

}  // namespace

ContentWatch::Stamp ContentWatch::stamp_of(const files::File& file) {
  struct stat status {};
  fstat(file.descriptor(), &status);
  return {static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec,
          status.st_mtim.tv_nsec};
}

void ContentWatch::begin() {
  index_.reset();
  sample_.reset();
  frames_.reset();
  is_file_settled_ = is_wal_settled_ = false;
}

NamedStore::Finding ContentWatch::look(Database& writing, const NamedStore& named, LookAt what) {
  const std::optional<WalIndex> before = read_wal_index(writing);
  if (!before || named.wal() == nullptr)
    return {};
  if (is_overwritten(named.file(), *before, writing))
    return {StoreChange::Overwritten, "it was overwritten"};
  const bool has_all = has_all_frames(*named.wal(), *before, what);
  const std::optional<WalIndex> after = read_wal_index(writing);
  const std::optional<WalIndex> last = std::exchange(index_, after ? after : before);
  const bool has_fewer = last && last->salts == before->salts && before->frames < last->frames;
  if (has_all && !has_fewer)
    return {};
  frames_.reset();
  if (!after || after->salts != before->salts || after->frames < before->frames)
    return {};  // another program reset it meanwhile: the next look tells
  const std::uint64_t size = named.wal()->size();
  const bool is_truncated = size < WalFrames::bytes_of(*after);
  // A checkpoint ends in the middle of a WAL that is too short, not of one that has other bytes.
  const bool was_moved =
      after->moved == after->frames &&
      (is_truncated || (last && last->has_same_frames(*after) && last->moved == last->frames));
  const std::string wal = "its WAL '" + named.wal_path().string() + "' was ";
  return {was_moved ? StoreChange::WalSpent : StoreChange::WalDamaged,
          wal + (is_truncated ? "truncated to " + std::to_string(size) + " bytes" : "overwritten")};
}

/// A checkpoint says what it moves before it writes, so the index is read after the file.
bool ContentWatch::is_overwritten(const files::File& file, const WalIndex& before,
                                  Database& writing) {
  const Stamp stamp = stamp_of(file);
  const bool is_as_in_last_look = stamp == std::exchange(file_stamp_, stamp);
  if (sample_ && is_as_in_last_look && is_file_settled_ && sample_->index.has_same_moves(before))
    return false;
  const std::uint32_t checksum = checksum_of_sample(file, before.page_bytes);
  const std::optional<WalIndex> after = read_wal_index(writing);
  is_file_settled_ = is_as_in_last_look;
  if (!after || may_be_moving(before, *after)) {
    sample_.reset();
    return false;
  }
  if (sample_ && sample_->index.has_same_moves(*after))
    return sample_->checksum != checksum;
  sample_ = {checksum, *after};
  is_file_settled_ = false;
  return false;
}

bool ContentWatch::has_all_frames(const files::File& wal, const WalIndex& index, LookAt what) {
  const Stamp stamp = stamp_of(wal);
  if (!WalFrames::has_ends(wal, stamp.size, index))
    return false;
  if (what == LookAt::Ends)
    return patrol(wal, stamp, index);
  WalFrames all(wal, index);
  return all.advance(index.frames) && (index.frames == 0 || all.checksum() == index.checksum);
}

/// Round after round over all frames, at a bounded rate, until nobody has written for a round.
bool ContentWatch::patrol(const files::File& wal, const Stamp& stamp, const WalIndex& index) {
  using std::chrono::steady_clock;
  const bool is_as_in_last_look = stamp == std::exchange(wal_stamp_, stamp);
  if (index.frames == 0 || (is_wal_settled_ && is_as_in_last_look)) {
    frames_.reset();
    return true;
  }
  is_wal_settled_ = false;
  if (!frames_ || !index_ || index_->salts != index.salts) {
    frames_.emplace(wal, index);
    round_stamp_ = stamp;
    is_round_settled_ = is_as_in_last_look;
  }
  constexpr std::chrono::milliseconds kLongestStep{250};
  const steady_clock::time_point now = steady_clock::now();
  const auto passed = std::min<steady_clock::duration>(now - patrolled_, kLongestStep);
  const auto bytes = static_cast<std::uint64_t>(std::chrono::duration<double>(passed).count() *
                                                static_cast<double>(kPatrol_bytes_per_s));
  const std::uint64_t until = std::min(index.frames, frames_->read() + bytes / index.page_bytes);
  if (until < std::min(index.frames, frames_->read() + WalFrames::kOfAStep))
    return true;  // so little time passed
  patrolled_ = now;
  if (!frames_->advance(until))
    return false;
  if (until < index.frames)
    return true;
  const bool is_last_right = frames_->checksum() == index.checksum;
  is_wal_settled_ = is_round_settled_ && stamp == round_stamp_;
  frames_.reset();
  return is_last_right;
}

}  // namespace kinship::store
