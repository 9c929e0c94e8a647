#include "pages/mcap/writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <ostream>
#include <stdexcept>

#include "proto/types/failure.hpp"

namespace kinship::mcap {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::string_view kCompression = "zstd";
constexpr std::size_t kChunkBytes = 1 << 20;  // of records, before a chunk ends

enum class Opcode : std::uint8_t {
  Header = 0x01,
  Footer = 0x02,
  Schema = 0x03,
  Channel = 0x04,
  Message = 0x05,
  Chunk = 0x06,
  MessageIndex = 0x07,
  ChunkIndex = 0x08,
  Statistics = 0x0B,
  Metadata = 0x0C,
  MetadataIndex = 0x0D,
  SummaryOffset = 0x0E,
  DataEnd = 0x0F
};

/// Bytes of a record's content, in the order of its members.
class Content {
 public:
  template <std::unsigned_integral Number>
  Content& number(Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      bytes_ += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFFU);
    return *this;
  }
  /// With its length before it: a text, or the entries of a list or map.
  Content& text(std::string_view value) {
    return number(static_cast<std::uint32_t>(value.size())).bytes(value);
  }
  Content& bytes(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

/// What stands before the content of a record.
std::string record_start(Opcode opcode, std::uint64_t content_bytes) {
  return Content().number(static_cast<std::uint8_t>(opcode)).number(content_bytes).bytes();
}

std::string record(Opcode opcode, const Content& content) {
  return record_start(opcode, content.bytes().size()) + content.bytes();
}

std::uint32_t crc32(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::string compressed(std::string_view bytes) {
  constexpr int kLevel = 3;
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0)
    throw Failure(ErrorCode::Internal, std::string("zstd: ") + ZSTD_getErrorName(size));
  result.resize(size);
  return result;
}

}  // namespace

void Writer::Span::include(std::uint64_t time, bool is_first) {
  begin = is_first ? time : std::min(begin, time);
  end = is_first ? time : std::max(end, time);
}

Writer::Writer(std::ostream& out, std::string_view library) : out_(out) {
  put(kMagic);
  put(record(Opcode::Header, Content().text("").text(library)));
}

std::uint16_t Writer::add_channel(std::string_view topic, const Schema& schema) {
  const auto [known, is_new] =
      schemas_.emplace(schema.name, static_cast<std::uint16_t>(schemas_.size() + 1));
  if (is_new) {
    const std::string text = record(
        Opcode::Schema,
        Content().number(known->second).text(schema.name).text("jsonschema").text(schema.text));
    schema_records_ += text;
    put(text);
  }
  const auto channel = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back(
      {record(Opcode::Channel,
              Content().number(channel).number(known->second).text(topic).text("json").text(""))});
  put(channels_.back().record);
  return channel;
}

void Writer::write(std::uint16_t channel, std::chrono::nanoseconds time, std::string_view json) {
  if (channel >= channels_.size() || time.count() < 0)
    throw std::invalid_argument("mcap::Writer: channel " + std::to_string(channel) + " of " +
                                std::to_string(channels_.size()) + ", time " +
                                std::to_string(time.count()) + " ns");
  const auto nanoseconds = static_cast<std::uint64_t>(time.count());
  Channel& to = channels_[channel];
  to.index.emplace_back(nanoseconds, chunk_.size());
  chunk_span_.include(nanoseconds, chunk_.empty());
  span_.include(nanoseconds, messages_ == 0);
  const Content head = Content()
                           .number(channel)
                           .number(static_cast<std::uint32_t>(to.messages))
                           .number(nanoseconds)
                           .number(nanoseconds);
  chunk_ += record_start(Opcode::Message, head.bytes().size() + json.size());
  chunk_ += head.bytes();
  chunk_ += json;
  ++to.messages;
  ++messages_;
  if (chunk_.size() >= kChunkBytes)
    end_chunk();
}

void Writer::add_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  Content entries;
  for (const auto& [key, value] : values)
    entries.text(key).text(value);
  const std::string text = record(Opcode::Metadata, Content().text(name).text(entries.bytes()));
  metadata_indexes_ +=
      record(Opcode::MetadataIndex,
             Content().number(offset_).number(std::uint64_t{text.size()}).text(name));
  ++metadata_;
  put(text);
}

void Writer::finish() {
  end_chunk();
  put(record(Opcode::DataEnd, Content().number(std::uint32_t{crc_.checksum()})));
  const std::uint64_t summary_start = offset_;
  put(summary(summary_start));
  out_.flush();
}

void Writer::put(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  crc_.process_bytes(bytes.data(), bytes.size());
  offset_ += bytes.size();
}

void Writer::end_chunk() {
  if (chunk_.empty())
    return;
  const std::uint64_t chunk_start = offset_;
  const std::string records = compressed(chunk_);
  put_chunk(records);
  const std::uint64_t indexes_start = offset_;
  Content places;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty())
      continue;
    const auto channel = static_cast<std::uint16_t>(i);
    Content entries;
    for (const auto& [time, place] : channels_[i].index)
      entries.number(time).number(place);
    channels_[i].index.clear();
    places.number(channel).number(offset_);
    put(record(Opcode::MessageIndex, Content().number(channel).text(entries.bytes())));
  }
  chunk_indexes_ += record(Opcode::ChunkIndex, Content()
                                                   .number(chunk_span_.begin)
                                                   .number(chunk_span_.end)
                                                   .number(chunk_start)
                                                   .number(indexes_start - chunk_start)
                                                   .text(places.bytes())
                                                   .number(offset_ - indexes_start)
                                                   .text(kCompression)
                                                   .number(std::uint64_t{records.size()})
                                                   .number(std::uint64_t{chunk_.size()}));
  ++chunks_;
  chunk_.clear();
}

void Writer::put_chunk(std::string_view records) {
  const Content head = Content()
                           .number(chunk_span_.begin)
                           .number(chunk_span_.end)
                           .number(std::uint64_t{chunk_.size()})
                           .number(crc32(chunk_))
                           .text(kCompression)
                           .number(std::uint64_t{records.size()});
  put(record_start(Opcode::Chunk, head.bytes().size() + records.size()));
  put(head.bytes());
  put(records);
}

std::string Writer::statistics() const {
  Content counts;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    counts.number(static_cast<std::uint16_t>(i)).number(channels_[i].messages);
  return record(Opcode::Statistics, Content()
                                        .number(messages_)
                                        .number(static_cast<std::uint16_t>(schemas_.size()))
                                        .number(static_cast<std::uint32_t>(channels_.size()))
                                        .number(std::uint32_t{0})  // attachments
                                        .number(metadata_)
                                        .number(chunks_)
                                        .number(span_.begin)
                                        .number(span_.end)
                                        .text(counts.bytes()));
}

/// Summary, the places of its groups, footer and magic.
/// \param start  of the summary in the file.
std::string Writer::summary(std::uint64_t start) const {
  std::string channels;
  for (const Channel& channel : channels_)
    channels += channel.record;
  const std::array<std::pair<Opcode, std::string>, 5> groups = {
      {{Opcode::Schema, schema_records_},
       {Opcode::Channel, channels},
       {Opcode::Statistics, statistics()},
       {Opcode::ChunkIndex, chunk_indexes_},
       {Opcode::MetadataIndex, metadata_indexes_}}};
  std::string text, offsets;
  for (const auto& [opcode, records] : groups) {
    if (records.empty())
      continue;
    offsets += record(Opcode::SummaryOffset, Content()
                                                 .number(static_cast<std::uint8_t>(opcode))
                                                 .number(start + text.size())
                                                 .number(std::uint64_t{records.size()}));
    text += records;
  }
  const Content places = Content().number(start).number(start + text.size());
  text += offsets;
  text += record_start(Opcode::Footer, places.bytes().size() + sizeof(std::uint32_t));
  text += places.bytes();
  text += Content().number(crc32(text)).bytes();
  return text.append(kMagic);
}

}  // namespace kinship::mcap
