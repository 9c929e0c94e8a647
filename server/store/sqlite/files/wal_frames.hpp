#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/files/file.hpp"

namespace kinship::store {

/// Of a frame and all before it.
using WalChecksum = std::array<std::uint32_t, 2>;

/// What SQLite's wal-index, which all programs at a database share, says about the WAL
/// (https://sqlite.org/walformat.html, section 2).
struct WalIndex {
  std::array<char, 8> salts{};   ///< of its frames, as its header has them; others after a reset
  std::uint64_t frames = 0;      ///< that were committed since the reset
  WalChecksum checksum{};        ///< of the last one
  std::uint64_t page_bytes = 0;  ///< of the database
  std::uint64_t moved = 0;       ///< the first frames, which the database file has too
  std::uint64_t moving = 0;  ///< the same once the checkpoint that runs, or ended early, is done

  bool has_same_frames(const WalIndex& other) const {
    return salts == other.salts && frames == other.frames && checksum == other.checksum;
  }
  bool has_same_moves(const WalIndex& other) const {
    return salts == other.salts && moved == other.moved && moving == other.moving;
  }
};

/// Reads the frames of a WAL in order, as SQLite does after a crash: the chain of their checksums
/// ends with the first one that is not as it was written.
class WalFrames {
 public:
  struct Frame {
    std::uint64_t page = 0;            ///< of the database, from 1 on
    std::uint64_t database_pages = 0;  ///< after the transaction that it ends; 0: it ends none
    std::string_view content;
  };
  using Take = std::function<void(const Frame&)>;

  static constexpr std::uint64_t kOfAStep = 32;  ///< frames that are read at once

  /// \param wal  outlives the object, which reads the header.
  WalFrames(const files::File& wal, const WalIndex& index);

  /// Reads on until so many frames are read in all, or one is not intact.
  /// \return whether so many are intact.
  bool advance(std::uint64_t until, const Take& take = {});

  std::uint64_t read() const noexcept { return read_; }  ///< all intact
  const WalChecksum& checksum() const noexcept { return checksum_; }

  /// Length of a WAL with the frames of its index.
  static std::uint64_t bytes_of(const WalIndex& index);

  /// Whether length, header and last frame of the WAL are those of its index: a few bytes are read.
  static bool has_ends(const files::File& wal, std::uint64_t size, const WalIndex& index);

 private:
  bool take_next(std::string_view frame, const Take& take);

  const files::File* wal_;
  std::array<char, 8> salts_;
  std::uint64_t page_bytes_;
  bool is_swapped_ = false;  // its words have the other order of bytes
  bool has_header_ = false;
  std::uint64_t read_ = 0;
  WalChecksum checksum_{};
  std::vector<char> bytes_;  // of some frames
};

}  // namespace kinship::store
