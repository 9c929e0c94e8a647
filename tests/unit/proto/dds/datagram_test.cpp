#include "proto/dds/datagram.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "tests/unit/proto/dds/datagrams.hpp"

namespace kinship::dds::datagram_test {
namespace {

using test::AnnouncementParts;
using test::Bytes;

/// From a block of exactly that size, so that AddressSanitizer sees a read beyond it.
std::optional<Datagram> read_exactly(const Bytes& bytes) {
  const auto block = std::make_unique<std::uint8_t[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), block.get());
  return read_datagram({block.get(), bytes.size()});
}

TEST(Datagram, TellsItsSenderAndItsAnnouncement) {
  const auto plain = read_exactly(test::announcement({.lease_s = 7}));
  ASSERT_TRUE(plain && plain->announcement);
  EXPECT_EQ(plain->sender, AnnouncementParts().sender);
  EXPECT_EQ(plain->announcement->lease, std::chrono::seconds(7));
  EXPECT_FALSE(plain->announcement->has_identity);
  EXPECT_FALSE(plain->announcement->is_departure);
  const auto named = read_exactly(test::announcement({.lease_s = {}, .has_identity = true}));
  ASSERT_TRUE(named && named->announcement);
  EXPECT_TRUE(named->announcement->has_identity);
  EXPECT_EQ(named->announcement->lease, std::chrono::seconds(100)) << "where none is said";
  const auto endless = read_exactly(test::announcement({.lease_s = 0x7fffffff}));
  ASSERT_TRUE(endless && endless->announcement);
  EXPECT_EQ(endless->announcement->lease, std::chrono::hours(24));
  const auto departure = read_exactly(test::announcement({.is_departure = true}));
  ASSERT_TRUE(departure && departure->announcement);
  EXPECT_TRUE(departure->announcement->is_departure);
}

TEST(Datagram, WithoutAnAnnouncementTellsItsSender) {
  Bytes bytes = test::rtps_header({9});
  test::append(bytes, test::submessage(0x07, 1, Bytes(28)));  // HEARTBEAT
  test::append(bytes, test::submessage(0x15, 1, Bytes(24)));  // DATA of another writer
  const auto datagram = read_exactly(bytes);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->sender, GuidPrefix{9});
  EXPECT_FALSE(datagram->announcement);
}

TEST(Datagram, TellsEachOfItsSenders) {
  Bytes bytes = test::announcement();
  const std::size_t first_end = bytes.size();
  const GuidPrefix second{7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
  test::append(bytes, test::source_submessage(second));
  test::append(bytes, test::announcement_submessage({.sender = second, .lease_s = 9}));
  const auto datagram = read_exactly(bytes);
  ASSERT_TRUE(datagram && datagram->announcement && datagram->others.size() == 1);
  EXPECT_EQ(datagram->others[0].sender, second);
  ASSERT_TRUE(datagram->others[0].announcement);
  EXPECT_EQ(datagram->others[0].announcement->lease, std::chrono::seconds(9));
  EXPECT_EQ(datagram->begin, 20U);
  EXPECT_EQ(datagram->end, first_end);
  EXPECT_EQ(datagram->others[0].begin, first_end);
  EXPECT_EQ(datagram->others[0].end, bytes.size());
  test::append(bytes, test::announcement_submessage({}));
  EXPECT_FALSE(read_exactly(bytes)) << "the first one's, by the second one";
}

TEST(Datagram, IsNotHeardIfItMightBeAnothersAnnouncement) {
  EXPECT_FALSE(read_exactly(test::announcement({.about = GuidPrefix{8}})));
  EXPECT_FALSE(read_exactly(test::announcement({.submessage = 0x16}))) << "in fragments";
  Bytes copies = test::announcement();
  test::append(copies, test::announcement_submessage({}));
  EXPECT_TRUE(read_exactly(copies));
  test::append(copies, test::announcement_submessage({}));
  EXPECT_FALSE(read_exactly(copies)) << "more work than it shows";
  Bytes two_guids = test::announcement();
  const Bytes guid = {0x50, 0, 4, 0, 0, 0, 0, 0};
  two_guids.insert(two_guids.end() - 4, guid.begin(), guid.end());
  two_guids.back() = 0;
  EXPECT_FALSE(read_exactly(two_guids));
}

TEST(Datagram, IsNotHeardIfOthersWouldDependOnItsSender) {
  EXPECT_TRUE(read_exactly(test::announcement({.version_flags = 0x2c}))) << "as Cyclone DDS says";
  EXPECT_FALSE(read_exactly(test::announcement({.version_flags = 0x3c}))) << "as a DDSI2 service";
}

TEST(Datagram, IsNotHeardIfItsStatusIsReadInTwoWays) {
  Bytes bytes = test::announcement({.is_departure = true});
  const Bytes status = {0x71, 0, 4, 0}, longer = {0x71, 0, 8, 0};
  const auto at = std::search(bytes.begin(), bytes.end(), status.begin(), status.end());
  ASSERT_NE(at, bytes.end());
  std::ranges::copy(longer, at);
  bytes.insert(at + 8, {0, 0, 0, 0});
  bytes[20 + 12 + 2] += 4;  // the length of the announcement
  EXPECT_FALSE(read_exactly(bytes));
}

TEST(Datagram, TellsOfItsSendersEndpointsAndLifeAlone) {
  const GuidPrefix sender{9}, other{8};
  const auto is_heard = [&](const GuidPrefix& about, std::uint8_t writer, std::uint8_t flags,
                            std::uint8_t id = 0x15) {
    Bytes bytes = test::rtps_header(sender);
    test::append(bytes, test::told_of(about, writer, flags, id));
    return read_exactly(bytes).has_value();
  };
  for (const std::uint8_t writer : Bytes{3, 4, 0})
    for (const std::uint8_t flags : Bytes{1 | 4, 1 | 2 | 4, 1 | 2 | 8, 1 | 2}) {
      EXPECT_TRUE(is_heard(sender, writer, flags)) << int(writer) << ' ' << int(flags);
      EXPECT_FALSE(is_heard(other, writer, flags)) << int(writer) << ' ' << int(flags);
    }
  EXPECT_FALSE(is_heard(sender, 3, 1)) << "about nothing";
  EXPECT_TRUE(is_heard(sender, 3, 1, 0x16)) << "a large announcement in fragments";
  EXPECT_FALSE(is_heard(sender, 3, 1 | 2, 0x16)) << "an end is not large";
  EXPECT_FALSE(is_heard(sender, 4, 1 | 4, 0x16)) << "nor a key";
  EXPECT_FALSE(is_heard(sender, 0, 1, 0x16));
}

TEST(Datagram, IsNotHeardIfItIsCutAnywhere) {
  const Bytes whole = test::announcement({.has_identity = true});
  ASSERT_TRUE(read_exactly(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto cut =
        read_exactly({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_FALSE(cut && cut->announcement) << size;
  }
}

TEST(Datagram, OfAnyBytesIsReadWithinThem) {
  std::mt19937_64 generator(20261128);
  const Bytes whole = test::announcement({.has_identity = true, .is_departure = true});
  int heard = 0;
  for (int round = 0; round < 100'000; ++round) {
    Bytes bytes = whole;
    for (std::uint64_t left = 1 + generator() % 4; left > 0; --left) {
      const std::size_t at = 4 + generator() % (bytes.size() - 4);
      bytes[at] = static_cast<std::uint8_t>(generator());
    }
    bytes.resize(generator() % 2 == 0 ? bytes.size() : 4 + generator() % bytes.size());
    heard += read_exactly(bytes) ? 1 : 0;
  }
  EXPECT_GT(heard, 1000) << "the rest is looked at";
  EXPECT_LT(heard, 90'000);
}

}  // namespace
}  // namespace kinship::dds::datagram_test
