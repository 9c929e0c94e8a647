#include "server/store/sqlite/database/checked_file.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/checked_vfs.hpp"
#include "server/store/sqlite/database/gathered_writes.hpp"
#include "server/store/sqlite/database/wal_frames.hpp"

namespace kinship::store {
namespace {

using ConstPage = std::span<const std::uint8_t>;

/// State that the connections of this process share about one database.
struct SharedRecord {
  std::shared_ptr<PageDamage> damage = std::make_shared<PageDamage>();
  WalFrames wal;
};

std::shared_ptr<SharedRecord> record_of(const std::string& database) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<SharedRecord>> records;
  const std::lock_guard lock(mutex);
  std::erase_if(records, [](const auto& entry) { return entry.second.expired(); });
  std::shared_ptr<SharedRecord> record = records[database].lock();
  if (!record)
    records[database] = record = std::make_shared<SharedRecord>();
  return record;
}

/// The current work of this thread.
thread_local bool copies_wal = false;   // a checkpoint runs
thread_local bool spoils_next = false;  // it has just read a page that is damaged in the WAL
thread_local int holes_allowed = 0;

enum class FileKind { Database, Wal, Other };

/// An open file below ours.
struct Below {
  std::unique_ptr<std::byte[]> memory;
  FileKind kind = FileKind::Other;
  std::shared_ptr<SharedRecord> record;  // of a database and its WAL
  std::optional<bool> sealed;            // empty: the database has no header yet
  std::vector<std::uint8_t> copy;        // of a page, to be sealed
  bool gathers = false;                  // a WAL's writes until they are synced or read
  GatheredWrites gathered;

  sqlite3_file* file() { return reinterpret_cast<sqlite3_file*>(memory.get()); }
  const sqlite3_io_methods& methods() { return *file()->pMethods; }
};

struct CheckedFile {
  sqlite3_file base;
  Below* below;
};

Below& below(sqlite3_file* file) { return *reinterpret_cast<CheckedFile*>(file)->below; }

constexpr std::size_t kHeaderBytes = 100;
constexpr std::size_t kReserveAt = 20;

/// Whether a database's header says that its pages bear checksums; nothing if it is no header.
std::optional<bool> sealed_by_header(ConstPage header) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  if (header.size() < kHeaderBytes || std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0)
    return std::nullopt;
  return header[kReserveAt] == kSealBytes;
}

bool is_sealed_file(Below& file) {
  if (!file.sealed) {
    std::array<std::uint8_t, kHeaderBytes> header{};
    if (file.methods().xRead(file.file(), header.data(), static_cast<int>(header.size()), 0) ==
        SQLITE_OK)
      file.sealed = sealed_by_header(header);
  }
  return file.sealed.value_or(false);
}

/// \param page  as read from the database file.
int judge_page(Below& file, ConstPage page, std::int64_t offset) {
  const std::uint64_t number = static_cast<std::uint64_t>(offset) / page.size() + 1;
  // A first page with a seal whose header denies it: the header is damaged.
  if (number == 1 && (bears_seal(page) || sealed_by_header(page)))
    file.sealed = bears_seal(page) || *sealed_by_header(page);
  if (!is_sealed_file(file) || is_sealed(page, number) || (holes_allowed > 0 && is_hole(page)))
    return SQLITE_OK;
  file.record->damage->note(number);
  return kDamagedPage;
}

int write_wal(Below& file, ConstPage bytes, std::int64_t offset) {
  const int code =
      file.methods().xWrite(file.file(), bytes.data(), static_cast<int>(bytes.size()), offset);
  if (code != SQLITE_OK)
    file.record->wal.forget(offset, bytes.size());
  return code;
}

/// Writes the gathered bytes. They are dropped if that fails: so is their commit.
int write_gathered(Below& file) {
  if (file.gathered.empty())
    return SQLITE_OK;
  const int code = write_wal(file, file.gathered.bytes(), file.gathered.offset());
  file.gathered.clear();
  return code;
}

int close_file(sqlite3_file* handle) {
  const std::unique_ptr<Below> file(&below(handle));
  const int gathered = write_gathered(*file);
  const int closed = file->methods().xClose(file->file());
  const int code = gathered != SQLITE_OK ? gathered : closed;
  if (file->kind == FileKind::Wal)
    file->record->wal.closed();
  return code;
}

int read_file(sqlite3_file* handle, void* out, int size, sqlite3_int64 offset) {
  Below& file = below(handle);
  if (const int code = write_gathered(file); code != SQLITE_OK)
    return code;
  const int code = file.methods().xRead(file.file(), out, size, offset);
  if (code != SQLITE_OK)
    return code;
  const ConstPage bytes(static_cast<const std::uint8_t*>(out), static_cast<std::size_t>(size));
  if (file.kind == FileKind::Database && is_page(bytes.size(), offset))
    return judge_page(file, bytes, offset);
  if (file.kind == FileKind::Wal && !file.record->wal.is_right(offset, bytes)) {
    if (!copies_wal)
      return kDamagedPage;
    spoils_next = true;  // the WAL gets free of it, and the page stays known as damaged
  }
  return SQLITE_OK;
}

int write_page(Below& file, ConstPage page, std::int64_t offset) {
  const std::uint64_t number = static_cast<std::uint64_t>(offset) / page.size() + 1;
  if (const auto sealed = number == 1 ? sealed_by_header(page) : std::nullopt)
    file.sealed = sealed;
  if (!is_sealed_file(file))
    return file.methods().xWrite(file.file(), page.data(), static_cast<int>(page.size()), offset);
  file.copy.assign(page.begin(), page.end());
  seal_page(file.copy, number);
  if (spoils_next)
    spoil_seal(file.copy);
  const int code = file.methods().xWrite(file.file(), file.copy.data(),
                                         static_cast<int>(file.copy.size()), offset);
  if (spoils_next)
    file.record->damage->note(number);
  else if (code == SQLITE_OK)
    file.record->damage->forget(number);
  spoils_next = false;
  return code;
}

int write_file(sqlite3_file* handle, const void* in, int size, sqlite3_int64 offset) {
  Below& file = below(handle);
  const ConstPage bytes(static_cast<const std::uint8_t*>(in), static_cast<std::size_t>(size));
  if (file.kind == FileKind::Database && is_page(bytes.size(), offset))
    return write_page(file, bytes, offset);
  if (file.kind != FileKind::Wal)
    return file.methods().xWrite(file.file(), in, size, offset);
  file.record->wal.written(offset, bytes);
  if (!file.gathers)
    return write_wal(file, bytes, offset);
  if (file.gathered.take(offset, bytes))
    return SQLITE_OK;
  if (const int code = write_gathered(file); code != SQLITE_OK) {
    file.record->wal.forget(offset, bytes.size());
    return code;
  }
  return file.gathered.take(offset, bytes) ? SQLITE_OK : write_wal(file, bytes, offset);
}

int truncate_file(sqlite3_file* handle, sqlite3_int64 size) {
  Below& file = below(handle);
  if (const int code = write_gathered(file); code != SQLITE_OK)
    return code;
  if (file.kind == FileKind::Wal)
    file.record->wal.truncated(size);
  return file.methods().xTruncate(file.file(), size);
}

int seal_empty(Below& file) {
  sqlite3_int64 size = 0;
  if (const int code = file.methods().xFileSize(file.file(), &size); code != SQLITE_OK)
    return code;
  if (size > 0)
    return SQLITE_NOTFOUND;
  file.sealed = true;
  return SQLITE_OK;
}

int control_database(Below& file, int operation, void* argument) {
  switch (operation) {
    case kSealIfEmpty:
      return seal_empty(file);
    case kSetSealed:
      file.sealed = *static_cast<const bool*>(argument);
      return SQLITE_OK;
    case kTellSealed:
      *static_cast<bool*>(argument) = is_sealed_file(file);
      return SQLITE_OK;
    case kTellDamage:
      *static_cast<std::shared_ptr<PageDamage>*>(argument) = file.record->damage;
      return SQLITE_OK;
    case SQLITE_FCNTL_CKPT_START:
    case SQLITE_FCNTL_CKPT_DONE:
      copies_wal = operation == SQLITE_FCNTL_CKPT_START;
      spoils_next = false;
      break;
    default:
      break;
  }
  return file.methods().xFileControl(file.file(), operation, argument);
}

int control_file(sqlite3_file* handle, int operation, void* argument) {
  Below& file = below(handle);
  return file.kind == FileKind::Database
             ? control_database(file, operation, argument)
             : file.methods().xFileControl(file.file(), operation, argument);
}

int device_characteristics(sqlite3_file* handle) {
  constexpr int kReadsPartsOfPages = 0x8000;  // SQLITE_IOCAP_SUBPAGE_READ; a seal is of all of it
  Below& file = below(handle);
  return file.methods().xDeviceCharacteristics(file.file()) & ~kReadsPartsOfPages;
}

int sync_file_below(sqlite3_file* handle, int flags) {
  const int code = write_gathered(below(handle));
  return code != SQLITE_OK ? code : below(handle).methods().xSync(below(handle).file(), flags);
}
int size_of_file(sqlite3_file* handle, sqlite3_int64* size) {
  const int code = write_gathered(below(handle));
  return code != SQLITE_OK ? code : below(handle).methods().xFileSize(below(handle).file(), size);
}
int lock_file(sqlite3_file* handle, int level) {
  return below(handle).methods().xLock(below(handle).file(), level);
}
int unlock_file(sqlite3_file* handle, int level) {
  return below(handle).methods().xUnlock(below(handle).file(), level);
}
int check_reserved_lock(sqlite3_file* handle, int* held) {
  return below(handle).methods().xCheckReservedLock(below(handle).file(), held);
}
int sector_size(sqlite3_file* handle) {
  return below(handle).methods().xSectorSize(below(handle).file());
}
int map_memory(sqlite3_file* handle, int region, int size, int extend, void volatile** memory) {
  return below(handle).methods().xShmMap(below(handle).file(), region, size, extend, memory);
}
int lock_memory(sqlite3_file* handle, int offset, int count, int flags) {
  return below(handle).methods().xShmLock(below(handle).file(), offset, count, flags);
}
void memory_barrier(sqlite3_file* handle) {
  below(handle).methods().xShmBarrier(below(handle).file());
}
int unmap_memory(sqlite3_file* handle, int remove) {
  return below(handle).methods().xShmUnmap(below(handle).file(), remove);
}

/// \param version  2: with shared memory. Never 3, with which SQLite would map pages unread.
constexpr sqlite3_io_methods make_methods(int version) {
  sqlite3_io_methods methods{};
  methods.iVersion = version;
  methods.xClose = close_file;
  methods.xRead = read_file;
  methods.xWrite = write_file;
  methods.xTruncate = truncate_file;
  methods.xSync = sync_file_below;
  methods.xFileSize = size_of_file;
  methods.xLock = lock_file;
  methods.xUnlock = unlock_file;
  methods.xCheckReservedLock = check_reserved_lock;
  methods.xFileControl = control_file;
  methods.xSectorSize = sector_size;
  methods.xDeviceCharacteristics = device_characteristics;
  methods.xShmMap = map_memory;
  methods.xShmLock = lock_memory;
  methods.xShmBarrier = memory_barrier;
  methods.xShmUnmap = unmap_memory;
  return methods;
}

constexpr sqlite3_io_methods kPlainMethods = make_methods(1);
constexpr sqlite3_io_methods kMethods = make_methods(2);

FileKind kind_of(int flags) {
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0)
    return FileKind::Database;
  return (flags & SQLITE_OPEN_WAL) != 0 ? FileKind::Wal : FileKind::Other;
}

}  // namespace

const int kCheckedFileBytes = static_cast<int>(sizeof(CheckedFile));

int open_checked(sqlite3_vfs& base, const char* name, sqlite3_file* file, int flags,
                 int* flags_out) {
  file->pMethods = nullptr;
  try {
    auto opened = std::make_unique<Below>();
    opened->memory = std::make_unique<std::byte[]>(static_cast<std::size_t>(base.szOsFile));
    opened->kind = name == nullptr ? FileKind::Other : kind_of(flags);
    if (opened->kind != FileKind::Other)
      opened->record = record_of(sqlite3_filename_database(name));
    const int code = base.xOpen(&base, name, opened->file(), flags, flags_out);
    if (code != SQLITE_OK) {
      if (opened->file()->pMethods != nullptr)
        opened->methods().xClose(opened->file());
      return code;
    }
    if (opened->kind == FileKind::Wal)
      opened->record->wal.opened();
    file->pMethods = opened->methods().iVersion >= 2 ? &kMethods : &kPlainMethods;
    reinterpret_cast<CheckedFile*>(file)->below = opened.release();
    return SQLITE_OK;
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  }
}

void gather_writes(sqlite3_file& file) {
  if (file.pMethods != &kMethods && file.pMethods != &kPlainMethods)
    throw std::logic_error("a file of another VFS cannot gather writes");
  below(&file).gathered.reserve();  // here, where running out of memory may throw
  below(&file).gathers = below(&file).kind == FileKind::Wal;
}

HolesAllowed::HolesAllowed() { ++holes_allowed; }
HolesAllowed::~HolesAllowed() { --holes_allowed; }

}  // namespace kinship::store
