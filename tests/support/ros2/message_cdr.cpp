#include "tests/support/ros2/message_cdr.hpp"

#include <rosidl_runtime_c/string_functions.h>
#include <rosidl_typesupport_introspection_c/field_types.h>
#include <rosidl_typesupport_introspection_c/message_introspection.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace kinship::test {
namespace {

using Members = rosidl_typesupport_introspection_c__MessageMembers;
using Member = rosidl_typesupport_introspection_c__MessageMember;
using String = rosidl_runtime_c__String;

constexpr std::size_t kEncapsulationBytes = 4;

const Members& members_of(const rosidl_message_type_support_t* type) {
  return *static_cast<const Members*>(type->data);
}

std::size_t size_of(const Member& member) {
  switch (member.type_id_) {
    case rosidl_typesupport_introspection_c__ROS_TYPE_BOOLEAN:
    case rosidl_typesupport_introspection_c__ROS_TYPE_UINT8:
      return 1;
    case rosidl_typesupport_introspection_c__ROS_TYPE_INT32:
    case rosidl_typesupport_introspection_c__ROS_TYPE_UINT32:
    case rosidl_typesupport_introspection_c__ROS_TYPE_FLOAT:
      return 4;
    case rosidl_typesupport_introspection_c__ROS_TYPE_INT64:
    case rosidl_typesupport_introspection_c__ROS_TYPE_UINT64:
    case rosidl_typesupport_introspection_c__ROS_TYPE_DOUBLE:
      return 8;
    default:
      throw std::runtime_error("type of " + std::string(member.name_));
  }
}

/// Walks over all values of a message in the order of the wire. A visitor has number(place, size,
/// member), text(place), and length(count of what is there), which says how many there are to be.
template <typename Visitor>
void walk(const Members& members, std::uint8_t* message, Visitor& visitor) {
  const auto value = [&](const Member& member, void* place) {
    if (member.type_id_ == rosidl_typesupport_introspection_c__ROS_TYPE_MESSAGE)
      walk(members_of(member.members_), static_cast<std::uint8_t*>(place), visitor);
    else if (member.type_id_ == rosidl_typesupport_introspection_c__ROS_TYPE_STRING)
      visitor.text(*static_cast<String*>(place));
    else
      visitor.number(place, size_of(member), member);
  };
  for (std::uint32_t i = 0; i < members.member_count_; ++i) {
    const Member& member = members.members_[i];
    void* const place = message + member.offset_;
    if (!member.is_array_) {
      value(member, place);
      continue;
    }
    std::size_t count = member.array_size_;
    if (count == 0 || member.is_upper_bound_) {
      const std::size_t present = member.size_function(place);
      count = visitor.length(present, member.is_upper_bound_ ? member.array_size_ : SIZE_MAX);
      if (count != present && !member.resize_function(place, count))
        throw std::runtime_error("cannot resize " + std::string(member.name_));
    }
    for (std::size_t j = 0; j < count; ++j)
      value(member, member.get_function(place, j));
  }
}

class Writer {
 public:
  void number(const void* place, std::size_t size, const Member& /*member*/) {
    bytes_.resize((bytes_.size() - kEncapsulationBytes + size - 1) / size * size +
                  kEncapsulationBytes);
    const auto* const first = static_cast<const std::uint8_t*>(place);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void text(const String& text) {
    write_length(text.size + 1);
    bytes_.insert(bytes_.end(), text.data, text.data + text.size + 1);
  }
  std::size_t length(std::size_t present, std::size_t /*bound*/) {
    write_length(present);
    return present;
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void write_length(std::size_t length) {
    const auto number32 = static_cast<std::uint32_t>(length);
    number(&number32, sizeof number32, {});
  }

  std::vector<std::uint8_t> bytes_ = {0, 1, 0, 0};
};

class Parser {
 public:
  explicit Parser(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  void number(void* place, std::size_t size, const Member& /*member*/) {
    position_ = (position_ - kEncapsulationBytes + size - 1) / size * size + kEncapsulationBytes;
    std::memcpy(place, take(size), size);
  }
  void text(String& text) {
    const std::size_t size = read_length();
    const auto* const first = reinterpret_cast<const char*>(take(size));
    if (size == 0 || !rosidl_runtime_c__String__assignn(&text, first, size - 1))
      throw std::runtime_error("text");
  }
  std::size_t length(std::size_t /*present*/, std::size_t bound) {
    const std::size_t count = read_length();
    if (count > bound || count > bytes_.size())
      throw std::runtime_error("list of " + std::to_string(count));
    return count;
  }
  /// Up to three bytes may follow, so that the whole is a multiple of four.
  bool is_at_end() const { return bytes_.size() - position_ < kEncapsulationBytes; }

 private:
  const std::uint8_t* take(std::size_t size) {
    if (position_ > bytes_.size() || size > bytes_.size() - position_)
      throw std::runtime_error("the bytes end too early");
    position_ += size;
    return bytes_.data() + position_ - size;
  }
  std::size_t read_length() {
    std::uint32_t length = 0;
    number(&length, sizeof length, {});
    return length;
  }

  const std::vector<std::uint8_t>& bytes_;
  std::size_t position_ = kEncapsulationBytes;
};

class Filler {
 public:
  void number(void* place, std::size_t size, const Member& member) {
    ++next_;
    if (member.type_id_ == rosidl_typesupport_introspection_c__ROS_TYPE_BOOLEAN)
      return put(place, next_ % 2 == 0);
    if (member.type_id_ == rosidl_typesupport_introspection_c__ROS_TYPE_DOUBLE)
      return put(place, static_cast<double>(next_) + 0.25);
    if (member.type_id_ == rosidl_typesupport_introspection_c__ROS_TYPE_FLOAT)
      return put(place, static_cast<float>(next_) + 0.5F);
    std::memcpy(place, &next_, size);  // the low bytes come first
  }
  void text(String& text) {
    const std::string words = "text " + std::to_string(++next_);
    rosidl_runtime_c__String__assign(&text, words.c_str());
  }
  static std::size_t length(std::size_t /*present*/, std::size_t bound) {
    return std::min<std::size_t>(3, bound);
  }

 private:
  template <typename Value>
  static void put(void* place, Value value) {
    std::memcpy(place, &value, sizeof value);
  }

  std::uint64_t next_ = 0;
};

}  // namespace

std::vector<std::uint8_t> to_cdr(const rosidl_message_type_support_t* type, const void* message) {
  Writer writer;
  // It changes nothing: lists keep their lengths.
  walk(members_of(type), static_cast<std::uint8_t*>(const_cast<void*>(message)), writer);  // NOLINT
  return writer.take();
}

void from_cdr(const rosidl_message_type_support_t* type, const std::vector<std::uint8_t>& bytes,
              void* message) {
  Parser parser(bytes);
  walk(members_of(type), static_cast<std::uint8_t*>(message), parser);
  if (!parser.is_at_end())
    throw std::runtime_error("bytes are left over");
}

void fill(const rosidl_message_type_support_t* type, void* message) {
  Filler filler;
  walk(members_of(type), static_cast<std::uint8_t*>(message), filler);
}

}  // namespace kinship::test
