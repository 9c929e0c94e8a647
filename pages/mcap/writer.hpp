#pragma once

#include <boost/crc.hpp>
#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinship::mcap {

/// A type of JSON messages, by its JSON Schema.
struct Schema {
  std::string name;  ///< by which viewers know the type
  std::string text;  ///< JSON Schema
};

/// Writes an MCAP file of JSON messages to a stream that need not be able to seek.
///
/// Messages go into chunks compressed by zstd. Memory holds one chunk, and for the summary some
/// hundred bytes of each chunk and some thirty of each metadata record. Equal calls, equal bytes.
/// The stream keeps errors of writing: its owner looks for them. Not for several threads.
/// Source: MCAP Format Specification, https://mcap.dev/spec.
class Writer {
 public:
  /// \param out      outlives the object.
  /// \param library  name and version of the program, for people.
  Writer(std::ostream& out, std::string_view library);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Begins a topic. \return its number for write().
  std::uint16_t add_channel(std::string_view topic, const Schema& schema);

  /// \param channel  from add_channel().
  /// \param time     since the epoch of the file, 0 or later.
  /// \param json     a message after the channel's schema.
  void write(std::uint16_t channel, std::chrono::nanoseconds time, std::string_view json);

  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);

  /// Writes what is left, and the summary. The last call.
  void finish();

 private:
  struct Channel {
    std::string record;
    std::uint64_t messages = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index = {};  // time and place in the chunk
  };
  /// Earliest and latest time of some messages; both 0 without any.
  struct Span {
    std::uint64_t begin = 0, end = 0;
    void include(std::uint64_t time, bool is_first);
  };

  void put(std::string_view bytes);
  void end_chunk();
  void put_chunk(std::string_view records);
  std::string summary(std::uint64_t start) const;
  std::string statistics() const;

  std::ostream& out_;
  std::uint64_t offset_ = 0;  // bytes written
  boost::crc_32_type crc_;    // of them
  std::map<std::string, std::uint16_t> schemas_;
  std::string schema_records_;
  std::vector<Channel> channels_;
  std::string chunk_;  // its records so far
  Span chunk_span_, span_;
  std::uint64_t messages_ = 0;
  std::uint32_t chunks_ = 0, metadata_ = 0;
  std::string chunk_indexes_, metadata_indexes_;  // records
};

}  // namespace kinship::mcap
