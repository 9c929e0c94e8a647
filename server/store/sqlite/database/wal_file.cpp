#include "server/store/sqlite/database/wal_file.hpp"

#include <fcntl.h>
#include <sqlite3.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "proto/files/file.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kBytesOfAStep = std::size_t{1} << 20U;

/// A connection that has SQLite's lock, so that no other program writes to the WAL or begins it
/// anew; empty if the file is damaged, so that nobody can.
std::unique_ptr<Database> keep_writers_out(const std::filesystem::path& file) try {
  constexpr int kPatience_ms = 5000;
  auto held = std::make_unique<Database>(file, Access::ReadWrite);
  sqlite3_db_config(&held->connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  sqlite3_busy_timeout(&held->connection(), kPatience_ms);
  held->execute("BEGIN IMMEDIATE");
  return held;
} catch (const SqliteError& error) {
  if (!error.is_damage())
    throw;
  return nullptr;
}

}  // namespace

void make_wal_durable(const std::filesystem::path& file) {
  const std::string name = file.string() + "-wal";
  std::error_code none;
  if (const auto size = std::filesystem::file_size(name, none); none || size == 0)
    return;
  const std::unique_ptr<Database> held = keep_writers_out(file);
  try {
    const files::File wal(name, O_RDWR | O_NOFOLLOW);  // SQLite's locks are on other files
    std::string bytes(kBytesOfAStep, '\0');
    std::uint64_t place = 0;
    while (const std::size_t size = wal.read(bytes.data(), bytes.size(), place)) {
      wal.write(std::string_view(bytes).substr(0, size), place);
      place += size;
    }
    if (place > 0)
      wal.sync();
  } catch (const files::FileError& error) {
    if (error.reason() != ENOENT)
      throw Failure(ErrorCode::Storage,
                    "'" + name + "' cannot be made durable: " + error.reason_text());
  }
}

std::optional<WalIndex> read_wal_index(Database& database) {
  constexpr int kRegion = 32768, kMethodsWithShm = 2;
  constexpr std::size_t kHeader = 48, kMoved = 96, kMoving = 128, kEnd = 136;
  constexpr std::uint32_t kVersion = 3'007'000;
  sqlite3_file* file = nullptr;
  sqlite3_file_control(&database.connection(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  volatile void* shared = nullptr;
  if (file == nullptr || file->pMethods == nullptr || file->pMethods->iVersion < kMethodsWithShm ||
      file->pMethods->xShmMap(file, 0, kRegion, 0, &shared) != SQLITE_OK || shared == nullptr)
    return std::nullopt;
  std::array<char, kEnd> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<const volatile char*>(shared)[i];
  const auto word = [&](std::size_t place) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes[place], sizeof value);
    return value;
  };
  std::uint16_t page_bytes = 0;  // 65536 does not fit
  std::memcpy(&page_bytes, &bytes[14], sizeof page_bytes);
  if (word(0) != kVersion || std::memcmp(bytes.data(), &bytes[kHeader], kHeader) != 0)
    return std::nullopt;
  WalIndex index{.frames = word(16),
                 .checksum = {word(24), word(28)},
                 .page_bytes = page_bytes == 1 ? 65536U : page_bytes,
                 .moved = word(kMoved),
                 .moving = word(kMoving)};
  std::memcpy(index.salts.data(), &bytes[32], index.salts.size());
  if (index.page_bytes == 0)
    return std::nullopt;
  return index;
}

bool checkpoint(Database& database, CheckpointKind kind) {
  const int mode =
      kind == CheckpointKind::Whole ? SQLITE_CHECKPOINT_TRUNCATE : SQLITE_CHECKPOINT_PASSIVE;
  int frames = 0;
  int copied = 0;
  const int code =
      sqlite3_wal_checkpoint_v2(&database.connection(), "main", mode, &frames, &copied);
  if (code == SQLITE_BUSY)
    return false;
  if (code != SQLITE_OK)
    throw_sqlite_error(database.connection(), "checkpoint");
  return frames == copied;
}

}  // namespace kinship::store
