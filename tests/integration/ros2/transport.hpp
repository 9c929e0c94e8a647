#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct dds_topic_descriptor;

/// A ROS node's middleware, as much of it as a test needs.
namespace kinship::test {

/// A message to be written, in both forms: the one that the middleware takes is used.
struct Outgoing {
  const void* sample = nullptr;   ///< idlc's structure
  std::vector<std::uint8_t> cdr;  ///< with its encapsulation
};

/// A topic by the names that ROS gives it.
struct TopicType {
  std::string name;                        ///< kinship_msgs::msg::dds_::Receipt_
  const dds_topic_descriptor* descriptor;  ///< idlc's
};

class Transport {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  virtual ~Transport() = default;

  /// Reliable, volatile, keep last 10. \return its number.
  virtual int open_writer(const std::string& topic, const TopicType& type) = 0;
  virtual void close_writer(int writer) = 0;
  /// The same; transient local if it is to get what was sent before.
  virtual int open_reader(const std::string& topic, const TopicType& type, bool is_late) = 0;

  /// \return false if nothing had matched by then.
  virtual bool wait_for_writer_match(int writer, Deadline deadline) = 0;
  virtual bool wait_for_reader_match(int reader, Deadline deadline) = 0;

  virtual void write(int writer, const Outgoing& message) = 0;
  /// \return nothing if none came by then; otherwise with its encapsulation.
  virtual std::optional<std::vector<std::uint8_t>> take(int reader, Deadline deadline) = 0;
};

/// Joins on loopback, or with ROS_LOCALHOST_ONLY=0 as nodes do that other hosts find by multicast.
/// Defined once for each middleware.
std::unique_ptr<Transport> join(std::uint32_t domain);

}  // namespace kinship::test
