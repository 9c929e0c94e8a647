#include "server/store/sqlite/files/wal_frames.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

namespace kinship::store {
namespace {

constexpr std::size_t kHeader = 32, kFrameHeader = 24;
constexpr std::size_t kSaltsAt = 16, kSaltsOfFrameAt = 8;  // the checksum is behind them
constexpr std::uint32_t kMagic = 0x377f0682;               // + 1: words of big-endian order

std::uint32_t word_at(std::string_view bytes, std::size_t place) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < sizeof word; ++i)
    word = word << 8U | static_cast<std::uint8_t>(bytes[place + i]);
  return word;
}

WalChecksum checksum_at(std::string_view bytes, std::size_t place) {
  return {word_at(bytes, place), word_at(bytes, place + sizeof(std::uint32_t))};
}

bool has_salts(std::string_view bytes, std::size_t place, const std::array<char, 8>& salts) {
  return bytes.substr(place, salts.size()) == std::string_view(salts.data(), salts.size());
}

/// Section 4.2 of the format. \param bytes  a multiple of 8.
void add_to(WalChecksum& sum, std::string_view bytes, bool is_swapped) {
  for (std::size_t place = 0; place < bytes.size(); place += sizeof(WalChecksum)) {
    WalChecksum words;
    std::memcpy(words.data(), bytes.data() + place, sizeof words);
    if (is_swapped)
      words = {__builtin_bswap32(words[0]), __builtin_bswap32(words[1])};
    sum[0] += words[0] + sum[1];
    sum[1] += words[1] + sum[0];
  }
}

/// \return what the file has of it.
std::string_view read_at(const files::File& file, std::span<char> bytes, std::uint64_t place) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::size_t got = file.read(&bytes[done], bytes.size() - done, place + done);
    if (got == 0)
      break;
    done += got;
  }
  return {bytes.data(), done};
}

std::uint64_t place_of(std::uint64_t frames, std::uint64_t page_bytes) {
  return kHeader + frames * (kFrameHeader + page_bytes);
}

}  // namespace

WalFrames::WalFrames(const files::File& wal, const WalIndex& index)
    : wal_(&wal), salts_(index.salts), page_bytes_(index.page_bytes) {
  constexpr std::size_t kPageBytesAt = 8, kChecksumAt = 24;
  std::array<char, kHeader> bytes{};
  const std::string_view header = read_at(wal, bytes, 0);
  if (header.size() < kHeader || (word_at(header, 0) & ~1U) != kMagic)
    return;
  is_swapped_ = (word_at(header, 0) & 1U) != (std::endian::native == std::endian::big ? 1U : 0U);
  add_to(checksum_, header.substr(0, kChecksumAt), is_swapped_);
  has_header_ = checksum_ == checksum_at(header, kChecksumAt) &&
                word_at(header, kPageBytesAt) == page_bytes_ && has_salts(header, kSaltsAt, salts_);
}

bool WalFrames::advance(std::uint64_t until, const Take& take) {
  const std::size_t frame_bytes = kFrameHeader + page_bytes_;
  while (has_header_ && read_ < until) {
    const std::uint64_t wanted = std::min(until - read_, kOfAStep);
    bytes_.resize(std::max(bytes_.size(), wanted * frame_bytes));
    const std::string_view bytes =
        read_at(*wal_, std::span(bytes_).first(wanted * frame_bytes), place_of(read_, page_bytes_));
    for (std::uint64_t i = 0; i < wanted; ++i)
      if (bytes.size() < (i + 1) * frame_bytes ||
          !take_next(bytes.substr(i * frame_bytes, frame_bytes), take))
        return false;
  }
  return read_ >= until;
}

bool WalFrames::take_next(std::string_view frame, const Take& take) {
  WalChecksum sum = checksum_;
  add_to(sum, frame.substr(0, kSaltsOfFrameAt), is_swapped_);
  add_to(sum, frame.substr(kFrameHeader), is_swapped_);
  if (!has_salts(frame, kSaltsOfFrameAt, salts_) ||
      sum != checksum_at(frame, kSaltsOfFrameAt + salts_.size()))
    return false;
  checksum_ = sum;
  ++read_;
  if (take)
    take({word_at(frame, 0), word_at(frame, sizeof(std::uint32_t)), frame.substr(kFrameHeader)});
  return true;
}

std::uint64_t WalFrames::bytes_of(const WalIndex& index) {
  return place_of(index.frames, index.page_bytes);
}

bool WalFrames::has_ends(const files::File& wal, std::uint64_t size, const WalIndex& index) {
  if (index.frames == 0)
    return true;
  if (size < bytes_of(index) || !WalFrames(wal, index).has_header_)
    return false;
  std::array<char, kFrameHeader> bytes{};
  const std::string_view last = read_at(wal, bytes, place_of(index.frames - 1, index.page_bytes));
  return last.size() == kFrameHeader && has_salts(last, kSaltsOfFrameAt, index.salts) &&
         checksum_at(last, kSaltsOfFrameAt + index.salts.size()) == index.checksum;
}

}  // namespace kinship::store
