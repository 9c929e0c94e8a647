#include "client/moveit/cdr_message.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::moveit::cdr_message_test {
namespace {

/// Packs CDR by hand, little endian.
class Packed {
 public:
  template <typename Number>
  Packed& add(Number number) {
    bytes_.resize(4 + (bytes_.size() - 4 + sizeof number - 1) / sizeof number * sizeof number);
    std::array<char, sizeof number> raw{};
    std::memcpy(raw.data(), &number, sizeof number);
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  Packed& text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.append(text.c_str(), text.size() + 1);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

Packed joint_state() {
  return Packed()
      .add(std::int32_t{7})
      .add(std::uint32_t{9})
      .text("base")
      .add(std::uint32_t{2})
      .text("a")
      .text("bcd")
      .add(std::uint32_t{2})
      .add(0.1)
      .add(-2.5e-9)
      .add(std::uint32_t{0})
      .add(std::uint32_t{0});
}

std::string complaint(const std::string& bytes, const char* message = "JointState") {
  try {
    read_cdr(bytes, message);
    return "";
  } catch (const Failure& failure) {
    return failure.what();
  }
}

TEST(ReadCdr, GivesWhatWasPacked) {
  const YAML::Node state = read_cdr(joint_state().bytes(), "JointState");
  EXPECT_EQ(state["header"]["stamp"]["sec"].as<int>(), 7);
  EXPECT_EQ(state["header"]["stamp"]["nanosec"].as<unsigned>(), 9U);
  EXPECT_EQ(state["header"]["frame_id"].as<std::string>(), "base");
  ASSERT_EQ(state["name"].size(), 2U);
  EXPECT_EQ(state["name"][1].as<std::string>(), "bcd");
  ASSERT_EQ(state["position"].size(), 2U);
  EXPECT_EQ(state["position"][0].as<double>(), 0.1);
  EXPECT_EQ(state["position"][1].as<double>(), -2.5e-9);
  EXPECT_EQ(state["effort"].size(), 0U);
}

TEST(ReadCdr, EveryShorterMessageIsRefused) {
  const std::string whole = joint_state().bytes();
  ASSERT_EQ(complaint(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(complaint(whole.substr(0, size)), "") << size;
  EXPECT_EQ(complaint(whole + std::string(8, '\0')), "") << "warehouses store padding";
  EXPECT_EQ(complaint(whole + std::string(9, '\0')), "9 bytes more than the message has");
}

TEST(ReadCdr, CountsAreBoundedBeforeAnythingIsMade) {
  const std::string bytes = Packed()
                                .add(std::int32_t{0})
                                .add(std::uint32_t{0})
                                .text("")
                                .add(std::uint32_t{0xffffffff})
                                .bytes();
  EXPECT_EQ(complaint(bytes), "name: 4294967295 values do not fit into the rest of the message");
  Packed many;
  many.add(std::uint32_t{600'000});
  for (int i = 0; i < 150'000; ++i)
    many.add(std::uint32_t{0x01010101});
  EXPECT_EQ(complaint(many.bytes(), "AllowedCollisionEntry"),
            "enabled: more than 500000 values in one message");
}

TEST(ReadCdr, OtherEncodingsAreRefused) {
  std::string bytes = joint_state().bytes();
  bytes[1] = 7;  // of XCDR2
  EXPECT_EQ(complaint(bytes), "is no plain CDR");
  EXPECT_EQ(complaint(std::string(2, '\1')), "is no plain CDR");
}

TEST(ReadCdr, HostileBytesAreReadOrRefused) {
  const std::string whole = joint_state().bytes();
  std::mt19937 generator(20261129);
  for (int round = 0; round < 4'000; ++round) {
    std::string bytes = whole;
    const auto changes = 1 + generator() % 4;
    for (unsigned change = 0; change < changes; ++change)
      bytes[4 + generator() % (bytes.size() - 4)] = static_cast<char>(generator());
    for (const char* message : {"JointState", "PlanningScene", "MotionPlanRequest"})
      complaint(bytes, message);
  }
}

}  // namespace
}  // namespace kinship::moveit::cdr_message_test
