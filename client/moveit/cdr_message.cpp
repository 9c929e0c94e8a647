#include "client/moveit/cdr_message.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>

#include "client/moveit/message_members.hpp"
#include "proto/types/failure.hpp"

namespace kinship::moveit {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::size_t kMaxPadding = 8;  // behind a message: warehouses store some

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {
    if (bytes.size() < kEncapsulationBytes || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1))
      throw Failure(ErrorCode::InvalidInput, "is no plain CDR");
    is_swapped_ = (bytes[1] == 1) != (std::endian::native == std::endian::little);
  }

  /// \param way  of the members to this one.
  YAML::Node read(std::string_view type, const std::string& way) {
    const MessageType kind = message_type(type);
    if (!kind.is_list)
      return read_one(kind.name, way);
    std::size_t count = kind.fixed_count;
    if (count == 0)
      count = number<std::uint32_t>(way);
    // Every value takes a byte at least.
    if (count > bytes_.size() - at_)
      refuse(way, std::to_string(count) + " values do not fit into the rest of the message");
    YAML::Node list(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < count; ++i)
      list.push_back(read_one(kind.name, way));
    return list;
  }

  void end() const {
    if (bytes_.size() - at_ > kMaxPadding)
      throw Failure(ErrorCode::InvalidInput,
                    std::to_string(bytes_.size() - at_) + " bytes more than the message has");
  }

 private:
  [[noreturn]] static void refuse(const std::string& way, const std::string& why) {
    throw Failure(ErrorCode::InvalidInput, way + ": " + why);
  }

  YAML::Node read_one(std::string_view type, const std::string& way) {
    if (const std::vector<Member>& members = members_of(type); !members.empty()) {
      YAML::Node message(YAML::NodeType::Map);
      for (const Member& member : members)
        if (member.use != MemberUse::NotInRos2)
          message[member.name] =
              read(member.type, way.empty() ? member.name : way + "." + member.name);
      return message;
    }
    if (++values_ > kMaxCdrValues)
      throw Failure(ErrorCode::TooLarge, way + ": more than " + std::to_string(kMaxCdrValues) +
                                             " values in one message");
    if (type == "string")
      return YAML::Node(text(way));
    if (type == "float64")
      return decimal(number<double>(way));
    if (type == "float32")
      return decimal(number<float>(way));
    if (type == "int32")
      return YAML::Node(number<std::int32_t>(way));
    if (type == "uint32")
      return YAML::Node(number<std::uint32_t>(way));
    if (type == "bool")
      return YAML::Node(number<std::uint8_t>(way) != 0);
    return YAML::Node(static_cast<unsigned>(number<std::uint8_t>(way)));  // uint8, int8
  }

  template <typename Number>
  static YAML::Node decimal(Number value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return YAML::Node(std::string(text.data(), end));
  }

  std::string_view take(std::size_t count, const std::string& way) {
    if (count > bytes_.size() - at_)
      refuse(way, "the message ends before it");
    const std::string_view taken = bytes_.substr(at_, count);
    at_ += count;
    return taken;
  }

  template <typename Number>
  Number number(const std::string& way) {
    const std::size_t beyond = (at_ - kEncapsulationBytes) % sizeof(Number);
    take(beyond == 0 ? 0 : sizeof(Number) - beyond, way);
    std::array<char, sizeof(Number)> raw{};
    std::ranges::copy(take(sizeof(Number), way), raw.begin());
    if (is_swapped_)
      std::ranges::reverse(raw);
    Number value;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }

  std::string text(const std::string& way) {
    const auto count = number<std::uint32_t>(way);  // with the zero at its end
    const std::string_view chars = take(count, way);
    if (count > 0 && chars.back() != '\0')
      refuse(way, "a text without end");
    return std::string(chars.substr(0, count == 0 ? 0 : count - 1));
  }

  std::string_view bytes_;
  std::size_t at_ = kEncapsulationBytes;
  std::size_t values_ = 0;
  bool is_swapped_ = false;
};

}  // namespace

YAML::Node read_cdr(std::string_view bytes, std::string_view message) {
  Reader reader(bytes);
  YAML::Node document = reader.read(message, "");
  reader.end();
  return document;
}

}  // namespace kinship::moveit
