#include "tests/faults/simulated_disk.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace kinship::test {
namespace {

constexpr std::uint64_t kSector = 512;

std::atomic<SimulatedDisk*> active_disk = nullptr;

std::vector<std::uint8_t> contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::uint64_t inode_of(const std::filesystem::path& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

long refuse(int error) {
  errno = error;
  return -1;
}

}  // namespace

SimulatedDisk::SimulatedDisk(const std::filesystem::path& directory, std::uint64_t seed)
    : directory_(std::filesystem::canonical(directory)),
      inode_(inode_of(directory_)),
      generator_(seed) {
  Names& names = names_.emplace_back();
  for (const auto& entry : std::filesystem::directory_iterator(directory_))
    if (entry.is_regular_file())
      names[entry.path().filename().string()] = adopt(entry.path());
  SimulatedDisk* none = nullptr;
  if (!active_disk.compare_exchange_strong(none, this))
    throw std::logic_error("SimulatedDisk: one at a time");
}

SimulatedDisk::~SimulatedDisk() { active_disk = nullptr; }

SimulatedDisk* SimulatedDisk::active() noexcept { return active_disk; }

std::shared_ptr<SimulatedDisk::File> SimulatedDisk::adopt(const std::filesystem::path& path) {
  auto file = std::make_shared<File>();
  file->name = path.filename().string();
  file->durable = contents(path);
  file->size = file->durable.size();
  files_[inode_of(path)] = file;
  return file;
}

void SimulatedDisk::on_change(std::function<void(std::uint64_t)> before) {
  const std::lock_guard lock(mutex_);
  before_ = std::move(before);
}

std::uint64_t SimulatedDisk::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

void SimulatedDisk::lie(bool lies) {
  const std::lock_guard lock(mutex_);
  lies_ = lies;
}

void SimulatedDisk::fail(const DiskFault& fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
  meant_ = 0;
}

std::uint64_t SimulatedDisk::failed() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

void SimulatedDisk::set_capacity(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  capacity_ = bytes;
}

std::uint64_t SimulatedDisk::used() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const auto& [name, file] : names_.back())
    bytes += file->size;
  return bytes;
}

std::optional<std::uint64_t> SimulatedDisk::room(const char* name) const {
  const std::lock_guard lock(mutex_);
  if (capacity_ == UINT64_MAX ||
      !std::filesystem::path(name).string().starts_with(directory_.string()))
    return std::nullopt;
  return capacity_ - std::min(capacity_, used());
}

DiskImage SimulatedDisk::image() {
  const std::lock_guard lock(mutex_);
  constexpr Kept kKinds[] = {Kept::Nothing, Kept::Everything, Kept::Some, Kept::Some, Kept::Some};
  const Kept kept = kKinds[generator_() % std::size(kKinds)];
  std::size_t names = names_.size() - 1;
  if (kept != Kept::Everything)
    names = kept == Kept::Nothing ? 0 : generator_() % names_.size();
  DiskImage image;
  for (const auto& [name, file] : names_[names]) {
    std::vector<std::uint8_t>& bytes = image[name] = file->durable;
    for (const Change& change : file->pending)
      apply(bytes, change, kept);
  }
  return image;
}

/// Brings a change, or what is kept of it, into what the disk has.
void SimulatedDisk::apply(std::vector<std::uint8_t>& bytes, const Change& change, Kept kept) {
  const std::uint64_t fate = generator_() % 3;  // of some: 0 lost, 1 kept, 2 torn
  if (kept == Kept::Nothing || (kept == Kept::Some && fate == 0))
    return;
  if (change.truncates) {
    bytes.resize(change.at);
    return;
  }
  const std::uint64_t end = change.at + change.bytes.size();
  for (std::uint64_t from = change.at, to = 0; from < end; from = to) {
    to = std::min(end, (from / kSector + 1) * kSector);
    if (kept == Kept::Some && fate == 2 && generator_() % 2 == 0)
      continue;
    if (bytes.size() < to)
      bytes.resize(to);
    const auto source = change.bytes.begin() + static_cast<std::ptrdiff_t>(from - change.at);
    std::copy_n(source, to - from, bytes.begin() + static_cast<std::ptrdiff_t>(from));
  }
}

/// Clean without having been written, or only in part: what Linux does when an fsync fails.
void SimulatedDisk::lose_pending(File& file) {
  const Kept kept = generator_() % 2 == 0 ? Kept::Nothing : Kept::Some;
  for (const Change& change : file.pending)
    apply(file.durable, change, kept);
  file.pending.clear();
}

std::optional<std::string> SimulatedDisk::name_here(const char* name) const {
  const std::filesystem::path path(name);
  if (path.parent_path() != directory_ || path.native().ends_with("-shm"))
    return std::nullopt;
  return path.filename().string();
}

std::shared_ptr<SimulatedDisk::File> SimulatedDisk::find(int file) const {
  struct stat status {};
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode))
    return nullptr;
  const auto found = files_.find(status.st_ino);
  return found == files_.end() ? nullptr : found->second;
}

/// Counts a change. \return the error that it has to end with; 0: none.
int SimulatedDisk::begin(DiskCall call, const std::string& name) {
  if (before_)
    before_(changes_);
  ++changes_;
  if (!fault_ || (fault_->calls & static_cast<unsigned>(call)) == 0 ||
      (!fault_->name.empty() && fault_->name != name))
    return 0;
  const std::uint64_t number = meant_++;
  if (number < fault_->first || number - fault_->first >= fault_->count)
    return 0;
  ++failed_;
  return fault_->error;
}

bool SimulatedDisk::has_room(const File& file, std::uint64_t size) const {
  return size <= file.size || used() + (size - file.size) <= capacity_;
}

void SimulatedDisk::rename_to(Names names) { names_.push_back(std::move(names)); }

long SimulatedDisk::open(const char* name, int flags, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::optional<std::string> here = name_here(name);
  const bool makes = here && (flags & O_CREAT) != 0 && inode_of(name) == 0;
  if (makes)
    if (const int error = begin(DiskCall::Name, *here); error != 0)
      return refuse(error);
  const long file = call();
  if (makes && file >= 0) {
    Names names = names_.back();
    names[*here] = adopt(name);
    rename_to(std::move(names));
  }
  return file;
}

long SimulatedDisk::write(int file, const void* bytes, std::size_t size, std::int64_t at,
                          const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<File> written = find(file);
  if (!written)
    return call();
  if (const int error = begin(DiskCall::Write, written->name); error != 0)
    return refuse(error);
  const auto from = static_cast<std::uint64_t>(at);
  if (!has_room(*written, from + size))
    return refuse(ENOSPC);
  const long count = call();
  if (count <= 0)
    return count;
  const auto* const first = static_cast<const std::uint8_t*>(bytes);
  written->pending.push_back({false, from, {first, first + count}});
  written->size = std::max(written->size, from + static_cast<std::uint64_t>(count));
  return count;
}

long SimulatedDisk::truncate(int file, std::int64_t size, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<File> cut = find(file);
  if (!cut)
    return call();
  if (const int error = begin(DiskCall::Truncate, cut->name); error != 0)
    return refuse(error);
  const long result = call();
  if (result == 0) {
    cut->size = static_cast<std::uint64_t>(size);
    cut->pending.push_back({true, cut->size, {}});
  }
  return result;
}

long SimulatedDisk::allocate(int file, std::int64_t size, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<File> grown = find(file);
  if (!grown)
    return call();
  if (const int error = begin(DiskCall::Write, grown->name); error != 0)
    return error;
  const auto bytes = static_cast<std::uint64_t>(size);
  if (!has_room(*grown, bytes))
    return ENOSPC;
  const long error = call();
  if (error == 0 && bytes > grown->size) {
    grown->size = bytes;
    grown->pending.push_back({true, bytes, {}});
  }
  return error;
}

long SimulatedDisk::sync(int file, const Call& call) {
  const std::lock_guard lock(mutex_);
  struct stat status {};
  if (fstat(file, &status) == 0 && S_ISDIR(status.st_mode) && status.st_ino == inode_) {
    if (const int error = begin(DiskCall::SyncDirectory, ""); error != 0)
      return refuse(error);
    if (!lies_)
      names_.erase(names_.begin(), names_.end() - 1);
    return 0;
  }
  const std::shared_ptr<File> synced = find(file);
  if (!synced)
    return call();
  if (const int error = begin(DiskCall::Sync, synced->name); error != 0) {
    lose_pending(*synced);
    return refuse(error);
  }
  if (lies_)
    return 0;
  for (const Change& change : synced->pending)
    apply(synced->durable, change, Kept::Everything);
  synced->pending.clear();
  return 0;
}

long SimulatedDisk::unlink(const char* name, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::optional<std::string> here = name_here(name);
  Names names = names_.back();
  if (!here || names.erase(*here) == 0)
    return call();
  if (const int error = begin(DiskCall::Name, *here); error != 0)
    return refuse(error);
  const long result = call();
  if (result == 0)
    rename_to(std::move(names));
  return result;
}

long SimulatedDisk::rename(const char* from, const char* to, bool exchange, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::optional<std::string> here = name_here(from);
  const std::optional<std::string> there = name_here(to);
  Names names = names_.back();
  if (!here || !there || !names.contains(*here))
    return call();
  if (const int error = begin(DiskCall::Name, *here); error != 0)
    return refuse(error);
  const long result = call();
  if (result != 0)
    return result;
  std::swap(names[*there], names[*here]);
  if (!exchange)
    names.erase(*here);
  rename_to(std::move(names));
  return result;
}

long SimulatedDisk::link(const char* from, const char* to, const Call& call) {
  const std::lock_guard lock(mutex_);
  const std::optional<std::string> here = name_here(from);
  const std::optional<std::string> there = name_here(to);
  Names names = names_.back();
  if (!here || !there || !names.contains(*here))
    return call();
  if (const int error = begin(DiskCall::Name, *here); error != 0)
    return refuse(error);
  const long result = call();
  if (result == 0) {
    names[*there] = names[*here];
    rename_to(std::move(names));
  }
  return result;
}

}  // namespace kinship::test
