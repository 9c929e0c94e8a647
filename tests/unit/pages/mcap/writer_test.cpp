#include "pages/mcap/writer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <stdexcept>

namespace kinship::mcap {
namespace {

using namespace std::chrono_literals;

const Schema kSchema{"test.Number", R"({"title":"test.Number","type":"object"})"};

/// Opcode and content of each record that is not in a chunk.
struct Record {
  char opcode;
  std::string content;
};

std::uint64_t number_at(std::string_view bytes, std::size_t place, std::size_t size) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.substr(place, size).data(), size);
  return value;
}

std::vector<Record> records_of(const std::string& file) {
  constexpr std::size_t kMagic = 8, kHead = 9;
  EXPECT_EQ(file.substr(0, kMagic), std::string("\x89MCAP0\r\n", kMagic));
  EXPECT_EQ(file.substr(file.size() - kMagic), file.substr(0, kMagic));
  std::vector<Record> records;
  for (std::size_t place = kMagic; place < file.size() - kMagic;) {
    const std::uint64_t size = number_at(file, place + 1, 8);
    records.push_back({file[place], file.substr(place + kHead, size)});
    place += kHead + size;
  }
  return records;
}

std::string opcodes_of(const std::vector<Record>& records) {
  std::string opcodes;
  for (const Record& record : records)
    opcodes += record.opcode;
  return opcodes;
}

TEST(McapWriter, AFileWithoutMessagesHasNoChunk) {
  std::ostringstream out;
  Writer writer(out, "test 1");
  writer.add_channel("/a", kSchema);
  writer.add_channel("/b", kSchema);  // of a known schema
  writer.finish();

  const std::vector<Record> records = records_of(out.str());

  // Header, schema, channels, end; schema, channels, statistics, three summary offsets, footer.
  EXPECT_EQ(opcodes_of(records),
            std::string("\x01\x03\x04\x04\x0F\x03\x04\x04\x0B\x0E\x0E\x0E\x02"));
  EXPECT_EQ(records[1].content, records[5].content);
}

TEST(McapWriter, ChunksEndAtAMegabyteAndAreIndexed) {
  std::ostringstream out;
  Writer writer(out, "test 1");
  const std::uint16_t channel = writer.add_channel("/a", kSchema);
  writer.add_metadata("facts", {{"key", "value"}});
  const std::string half(600'000, ' ');
  for (int i = 0; i < 3; ++i)
    writer.write(channel, i * 1s, half);
  writer.finish();

  const std::vector<Record> records = records_of(out.str());

  EXPECT_EQ(opcodes_of(records), std::string("\x01\x03\x04\x0C\x06\x07\x06\x07\x0F"
                                             "\x03\x04\x0B\x08\x08\x0D\x0E\x0E\x0E\x0E\x0E\x02"));
  EXPECT_EQ(number_at(records[4].content, 8, 8), 1'000'000'000U) << "end of the first chunk";
  EXPECT_EQ(number_at(records[6].content, 0, 8), 2'000'000'000U) << "begin of the second";
  EXPECT_EQ(number_at(records[4].content, 16, 8), 2 * (9 + 22 + half.size())) << "not compressed";
  EXPECT_LT(records[4].content.size(), 10'000U);
}

TEST(McapWriter, CrcIsThatOfZlib) {
  std::ostringstream out;
  Writer writer(out, "");
  writer.finish();

  const std::vector<Record> records = records_of(out.str());

  // zlib.crc32(b"\x89MCAP0\r\n\x01" + (8).to_bytes(8, "little") + bytes(8)) in Python
  EXPECT_EQ(number_at(records[1].content, 0, 4), 0xEBFAC373U);
}

TEST(McapWriter, RefusesUnknownChannelsAndTimesBeforeTheEpoch) {
  std::ostringstream out;
  Writer writer(out, "test 1");
  EXPECT_THROW(writer.write(0, 0s, "{}"), std::invalid_argument);
  const std::uint16_t channel = writer.add_channel("/a", kSchema);
  EXPECT_THROW(writer.write(channel, -1ns, "{}"), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::mcap
