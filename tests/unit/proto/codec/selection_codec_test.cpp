#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "proto/codec/fetch_codec.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::selection_codec_test {
namespace {

constexpr std::uint64_t kSeed = 35;

FetchRequest request_of(std::size_t sources) {
  test::RandomValues values(kSeed);
  FetchRequest request;
  request.task = "t";
  request.selection.since_ms = 1;
  for (std::size_t i = 0; i < sources; ++i)
    request.selection.sources.push_back(values.digest());
  std::sort(request.selection.sources.begin(), request.selection.sources.end());
  return request;
}

std::string complaint(const FetchRequest& request) {
  const auto message = encode({}, request);
  return message ? "" : message.error().message;
}

TEST(SelectionCodec, EverythingIsTheAbsenceOfASelection) {
  FetchRequest request = request_of(0);
  request.selection = {};
  const auto message = encode({}, request).value_or_throw();
  EXPECT_EQ(message.wire.selection._length, 0U);
  EXPECT_EQ(decode(message.wire)->selection, Selection{});
}

TEST(SelectionCodec, SourcesAreAscendingDistinctAndAtMost256) {
  EXPECT_EQ(complaint(request_of(256)), "");
  EXPECT_EQ(complaint(request_of(257)), "sources of the selection: 257 exceeds 256");
  FetchRequest request = request_of(2);
  std::swap(request.selection.sources[0], request.selection.sources[1]);
  EXPECT_EQ(complaint(request), "sources of the selection: not ascending and distinct");
  request.selection.sources[0] = request.selection.sources[1];
  EXPECT_EQ(complaint(request), "sources of the selection: not ascending and distinct");
}

TEST(SelectionCodec, TimeIsNotNegativeAndALeaseIsLimited) {
  FetchRequest request = request_of(0);
  request.selection.since_ms = -1;
  EXPECT_EQ(complaint(request), "since (ms): -1 is negative");
  request = request_of(0);
  request.follow = std::chrono::seconds(86'401);
  EXPECT_EQ(complaint(request), "follow_s: 86401 is not between 0 and 86400");
}

/// What decoding says to a message in which something was changed.
template <typename Change>
std::string answer_to(Change change) {
  auto message = encode({}, request_of(2)).value_or_throw();
  change(message.wire.selection._buffer[0]);
  const auto read = decode(message.wire);
  return read ? "accepted" : read.error().message;
}

TEST(SelectionCodec, IncomingOneIsCheckedLikeAnOutgoingOne) {
  EXPECT_EQ(answer_to([](auto&) {}), "accepted");
  EXPECT_EQ(answer_to([](auto& wire) { wire.sources._length = 31; }),
            "sources of the selection: 31 bytes are not a multiple of 32");
  EXPECT_EQ(answer_to([](auto& wire) { wire.sources._buffer[0] = 255; }),
            "sources of the selection: not ascending and distinct");
  EXPECT_EQ(answer_to([](auto& wire) { wire.weighting = 3; }),
            "weighting: 3 is not between 0 and 2");
  EXPECT_EQ(answer_to([](auto& wire) { wire.since_ms = -5; }), "since (ms): -5 is negative");
  EXPECT_EQ(answer_to([](auto& wire) { wire.sources._buffer = nullptr; }), "accepted");  // all
}

TEST(SelectionCodec, TooManySourcesAreRefusedBeforeTheyAreRead) {
  auto message = encode({}, request_of(256)).value_or_throw();
  auto& sources = message.wire.selection._buffer[0].sources;
  const std::vector<std::uint8_t> bytes(std::size_t{257} * 32);
  sources._buffer = const_cast<std::uint8_t*>(bytes.data());
  sources._length = 257 * 32;
  EXPECT_EQ(decode(message.wire).error().message, "sources of the selection: 257 exceeds 256");
}

}  // namespace
}  // namespace kinship::codec::selection_codec_test
