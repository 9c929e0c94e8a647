#include "proto/json/reader.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace kinship::json::reader_test {
namespace {

/// The member "x" of a document, read as a finite number.
Result<double> read_x(std::string_view text) {
  return read_document(text, "document", [](const Reader& root) { return root.at("x").number(); });
}

std::string message_of(std::string_view text) { return read_x(text).error().message; }

TEST(Reader, DeepNestingIsRefusedBeforeItIsParsed) {
  constexpr std::size_t kLevels = 1'000'000;
  const auto result = read_x("{\"x\":" + std::string(kLevels, '[') + std::string(kLevels, ']'));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::TooLarge);
  EXPECT_EQ(result.error().message, "document: 33 nested levels exceed 32");
}

TEST(Reader, TooManyValuesAreRefusedBeforeTheyAreParsed) {
  std::string text = "{\"x\":1,\"y\":[0";
  for (std::size_t i = 0; i < kMaxDocumentValues; ++i)
    text += ",0";
  const auto result = read_x(text + "]}");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::TooLarge);
}

TEST(Reader, BracketsAndQuotesInsideStringsAreText) {
  const std::string text = R"({"y": ")" + std::string(100, '[') + R"(\"{{{,", "x": 2})";
  EXPECT_EQ(read_x(text).value(), 2);
}

TEST(Reader, WhatIsNotJsonNamesTheByte) {
  EXPECT_EQ(message_of("{\"x\": 1,}"), "document: not JSON at byte 9");
  EXPECT_EQ(message_of(""), "document: not JSON at byte 1");
  EXPECT_EQ(message_of("{\"x\": NaN}"), "document: not JSON at byte 7");
  EXPECT_EQ(message_of("{\"x\": 1} {}"), "document: not JSON at byte 10");
  EXPECT_EQ(message_of("{\"\xff\": 1}"), "document: not JSON at byte 3");
}

TEST(Reader, NumberThatOverflowsIsRefused) {
  EXPECT_EQ(message_of("{\"x\": 1e999}"), "document: a number is too large for a double");
  EXPECT_EQ(message_of("{\"x\": -1e999}"), "document: a number is too large for a double");
}

TEST(Reader, WrongTypesNamePlaceAndType) {
  EXPECT_EQ(message_of("[1]"), "document: must be an object, is array");
  EXPECT_EQ(message_of("{}"), "x: is missing");
  EXPECT_EQ(message_of("{\"x\": \"1\"}"), "x: must be a number, is string");
  EXPECT_EQ(message_of("{\"x\": null}"), "x: must be a number, is null");
  EXPECT_EQ(message_of("{\"x\": true}"), "x: must be a number, is boolean");
}

TEST(Reader, RangesNameValueAndLimit) {
  const auto share = [](const Reader& root) { return root.at("a").at("b").number(0, 1); };
  EXPECT_EQ(read_document(R"({"a": {"b": 1.5}})", "document", share).error().message,
            "a.b: 1.5 exceeds 1");
  EXPECT_EQ(read_document(R"({"a": {"b": -0.25}})", "document", share).error().message,
            "a.b: -0.25 is below 0");
  EXPECT_TRUE(read_document(R"({"a": {"b": 1}})", "document", share));
}

TEST(Reader, CountsAreIntegersOf64Bits) {
  const auto count = [](const Reader& root) { return root.at("x").count(); };
  EXPECT_EQ(read_document(R"({"x": 18446744073709551615})", "document", count).value(),
            std::numeric_limits<std::uint64_t>::max());
  for (const char* bad : {"-1", "1.0", "1e3", "18446744073709551616", "\"1\""})
    EXPECT_FALSE(read_document(R"({"x": )" + std::string(bad) + "}", "document", count)) << bad;
}

TEST(Reader, IntegersAreSigned) {
  const auto integer = [](const Reader& root) { return root.at("x").integer(); };
  EXPECT_EQ(read_document(R"({"x": -9223372036854775808})", "document", integer).value(),
            std::numeric_limits<std::int64_t>::min());
  for (const char* bad : {"9223372036854775808", "0.5", "null"})
    EXPECT_FALSE(read_document(R"({"x": )" + std::string(bad) + "}", "document", integer)) << bad;
}

TEST(Reader, TextIsLimitedInBytes) {
  const auto text = [](const Reader& root) { return root.at("x").text(3); };
  EXPECT_EQ(read_document(R"({"x": "abc"})", "document", text).value(), "abc");
  EXPECT_EQ(read_document(R"({"x": "abcd"})", "document", text).error().message,
            "x: 4 bytes exceed 3");
}

TEST(Reader, ColumnsMustBeEquallyLongAndFinite) {
  const auto columns = [](const Reader& root) { return root.at("x").columns(2, 3); };
  const auto message = [&](std::string_view value) {
    return read_document("{\"x\": " + std::string(value) + "}", "document", columns)
        .error()
        .message;
  };
  Eigen::Matrix2d expected;
  expected << 1, 3, 2, 4;
  EXPECT_EQ(read_document("{\"x\": [[1, 2], [3, 4]]}", "document", columns).value(), expected);
  EXPECT_EQ(message("[[1, 2], [3]]"), "x[1]: 1 numbers, the first has 2");
  EXPECT_EQ(message("[[1], [2], [3], [4]]"), "x: 4 elements exceed 3");
  EXPECT_EQ(message("[[1, 2, 3]]"), "x[0]: 3 elements exceed 2");
  EXPECT_EQ(message("[[1, null]]"), "x[0][1]: must be a number, is null");
  EXPECT_EQ(message("[1]"), "x[0]: must be an array, is number");
}

TEST(Reader, PoseNeedsSevenNumbersAndAUnitQuaternion) {
  const auto pose = [](const Reader& root) { return root.at("x").pose(); };
  const auto read = [&](std::string_view value) {
    return read_document("{\"x\": " + std::string(value) + "}", "document", pose);
  };
  EXPECT_EQ(read("[1, 2, 3, 0, 0, 0, 1]").value().translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read("[1, 2, 3, 0, 0, 1]").error().message,
            "x: 6 numbers, must be 7: x y z qx qy qz qw");
  EXPECT_FALSE(read("[1, 2, 3, 0, 0, 0, 2]"));
  EXPECT_FALSE(read("[1e9, 2, 3, 0, 0, 0, 1]"));
}

TEST(Reader, IdentitiesAreShownWhenRefused) {
  const auto digest = [](const Reader& root) { return root.at("x").digest().hex(); };
  const auto uuid = [](const Reader& root) { return root.at("x").uuid().text(); };
  EXPECT_EQ(read_document(R"({"x": "12"})", "document", digest).error().message,
            "x: '12' is not 64 hexadecimal digits");
  EXPECT_EQ(read_document(R"({"x": "12"})", "document", uuid).error().message,
            "x: '12' is not a UUID (8-4-4-4-12)");
}

}  // namespace
}  // namespace kinship::json::reader_test
