#include "proto/dds/message_guard.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata_default.h>  // the next one needs it
#include <dds/ddsi/ddsi_xt_impl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

#include "proto/dds/wire.hpp"
#include "tests/support/places.hpp"

namespace kinship::dds::message_guard_test {
namespace {

constexpr std::uint32_t kXcdr2 = 2;

/// The bytes of a pinned message (tests/golden).
std::vector<std::uint8_t> pinned(const std::string& name) {
  std::ifstream file(test::source_dir() + "/tests/golden/pins/wire/" + name + ".hex");
  std::string digits((std::istreambuf_iterator<char>(file)), {});
  std::erase_if(digits, [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) == 0; });
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

struct Pin {
  const char* name;
  const dds_topic_descriptor_t& type;
};

const Pin kPins[] = {{"register_request", kinship_wire_RegisterRequest_desc},
                     {"register_reply", kinship_wire_RegisterReply_desc},
                     {"report_request", kinship_wire_ReportRequest_desc},
                     {"report_reply", kinship_wire_ReportReply_desc},
                     {"fetch_request", kinship_wire_FetchRequest_desc},
                     {"fetch_reply", kinship_wire_FetchReply_desc},
                     {"fetch_reply_kernels", kinship_wire_FetchReply_desc},
                     {"admin_request", kinship_wire_AdminRequest_desc},
                     {"admin_reply", kinship_wire_AdminReply_desc},
                     {"announcement", kinship_wire_Announcement_desc},
                     {"event", kinship_wire_Event_desc}};

TEST(MessageGuard, IsInFrontOfCycloneDds) { EXPECT_TRUE(is_message_guard_in_place()); }

/// Cyclone DDS 0.10.2 ends the process at some.
TEST(MessageGuard, ATypeOfAnyKindButTheTwoOfHashesIsInvalid) {
  for (unsigned kind = 0; kind < 256; ++kind) {
    ddsi_typeinfo type{};
    auto& minimal = type.x.minimal.typeid_with_size.type_id._d;
    auto& complete = type.x.complete.typeid_with_size.type_id._d;
    minimal = complete = static_cast<std::uint8_t>(kind);
    EXPECT_FALSE(ddsi_typeinfo_valid(&type)) << kind;
    minimal = DDS_XTypes_EK_MINIMAL;
    EXPECT_EQ(ddsi_typeinfo_valid(&type), kind == DDS_XTypes_EK_COMPLETE) << kind;
    complete = DDS_XTypes_EK_COMPLETE;
    EXPECT_TRUE(ddsi_typeinfo_valid(&type));
  }
}

TEST(MessageGuard, LetsEveryMessagePass) {
  for (const Pin& pin : kPins) {
    const std::vector<std::uint8_t> bytes = pinned(pin.name);
    ASSERT_GT(bytes.size(), 8U) << pin.name;
    EXPECT_FALSE(overruns(bytes, false, kXcdr2, pin.type.m_ops)) << pin.name;
  }
}

TEST(MessageGuard, KnowsShortRequestsThatAreLong) {
  EXPECT_FALSE(is_too_long(kMaxShortRequestBytes, "kinship::wire::FetchRequest"));
  EXPECT_TRUE(is_too_long(kMaxShortRequestBytes + 1, "kinship::wire::FetchRequest"));
  EXPECT_TRUE(is_too_long(kMaxShortRequestBytes + 1, "kinship::wire::AdminRequest"));
  EXPECT_FALSE(is_too_long(1'200'000, "kinship::wire::ReportRequest"));
  EXPECT_TRUE(is_too_long(kMaxShortRequestBytes + 1, "kinship_msgs::srv::dds_::Fetch_Request_"));
  EXPECT_FALSE(is_too_long(kMaxShortPathBytes, "kinship_msgs::msg::dds_::PlannedPath_"));
  EXPECT_TRUE(is_too_long(kMaxShortPathBytes + 1, "kinship_msgs::srv::dds_::Report_Request_"));
}

TEST(MessageGuard, LetsSomeLongRequestsInASecond) {
  LongRequests requests;
  const auto now = std::chrono::steady_clock::now();
  for (int i = 0; i < LongRequests::kMaxPerSecond; ++i)
    EXPECT_TRUE(requests.admit(now));
  EXPECT_FALSE(requests.admit(now + std::chrono::milliseconds(999)));
  EXPECT_TRUE(requests.admit(now + std::chrono::seconds(1)));
}

/// As an older client sends it.
TEST(MessageGuard, LetsAMessagePassThatEndsAfterAMember) {
  std::vector<std::uint8_t> bytes(4 + 16 + 8);  // size, client, sequence number
  bytes[0] = 16 + 8;
  for (const Pin& pin : kPins)
    if (std::string_view(pin.name).ends_with("_request")) {
      EXPECT_FALSE(overruns(bytes, false, kXcdr2, pin.type.m_ops)) << pin.name;
    }
}

TEST(MessageGuard, RefusesAMessageThatIsCutAnywhere) {
  for (const Pin& pin : kPins) {
    const std::vector<std::uint8_t> bytes = pinned(pin.name);
    for (std::size_t size = bytes.size() - 1; size > 4; --size) {
      const std::span<const std::uint8_t> cut(bytes.data(), size);
      ASSERT_TRUE(overruns(cut, false, kXcdr2, pin.type.m_ops)) << pin.name << " " << size;
    }
  }
}

/// The list stands last in its structure: 48 of the bytes that it claims are there.
TEST(MessageGuard, RefusesDoublesOfWhichHalfAreThere) {
  const auto bytes_with = [](std::uint8_t count) {
    std::vector<std::uint8_t> bytes(4 + 16 + 8);  // size, client, sequence number
    const auto add = [&bytes](std::initializer_list<std::uint8_t> more, std::size_t size) {
      bytes.insert(bytes.end(), more);
      bytes.resize(bytes.size() + size - more.size());
    };
    add({4 + 4 + 68 + 48}, 4);  // bytes of the list of attempts
    add({1}, 4);                // their number
    add({68 + 48}, 4);          // bytes of the attempt
    add({}, 48);                // report, robot
    add({1}, 8), add({1}, 8);   // machine, task
    add({count}, 4);            // T_task_base
    add({}, 48);
    bytes[0] = static_cast<std::uint8_t>(bytes.size() - 4);
    return bytes;
  };
  const std::uint32_t* const ops = kinship_wire_ReportRequest_desc.m_ops;
  EXPECT_FALSE(overruns(bytes_with(6), false, kXcdr2, ops));
  EXPECT_TRUE(overruns(bytes_with(7), false, kXcdr2, ops));
  EXPECT_TRUE(overruns(bytes_with(12), false, kXcdr2, ops));
}

}  // namespace
}  // namespace kinship::dds::message_guard_test
