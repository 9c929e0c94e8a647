#include "proto/dds/peer_table.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <vector>

namespace kinship::dds::peer_table_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using enum PacketVerdict;

const PacketSource kHere = PacketSource::ipv4({127, 0, 0, 1}, 40'000);
const PacketSource kElsewhere = PacketSource::ipv4({10, 0, 0, 9}, 40'000);

GuidPrefix prefix(std::uint64_t number) {
  GuidPrefix prefix{};
  std::memcpy(prefix.data(), &number, sizeof number);
  return prefix;
}

class PeerTableTest : public testing::Test {
 protected:
  PacketVerdict announce(std::uint64_t who, const PacketSource& source,
                         ParticipantAnnouncement announcement = {.lease = seconds(5)}) {
    return take(Datagram{prefix(who), announcement, {}}, source);
  }
  PacketVerdict speak(std::uint64_t who, const PacketSource& source) {
    return take(Datagram{prefix(who), std::nullopt, {}}, source);
  }
  PacketVerdict take(const std::optional<Datagram>& datagram, const PacketSource& source) {
    return table_.take(datagram, source, source.address_text().starts_with("127."), needs_identity_,
                       now_);
  }

  PeerTable table_;
  bool needs_identity_ = false;
  PeerTable::TimePoint now_{std::chrono::hours(1)};
};

TEST_F(PeerTableTest, HearsAParticipantFromThePlaceOfItsFirstAnnouncement) {
  EXPECT_EQ(speak(1, kHere), Stranger);
  EXPECT_EQ(announce(1, kHere), Heard);
  EXPECT_EQ(speak(1, kHere), Heard);
  EXPECT_EQ(speak(1, PacketSource::ipv4({127, 0, 0, 2}, 7)), Heard) << "another of this machine";
  EXPECT_EQ(speak(1, kElsewhere), OtherPlace);
  EXPECT_EQ(announce(1, kElsewhere), OtherPlace);
  EXPECT_TRUE(table_.find(prefix(1))->is_local);

  EXPECT_EQ(announce(2, kElsewhere), Heard);
  EXPECT_EQ(speak(2, kHere), OtherPlace);
  EXPECT_EQ(speak(2, PacketSource::ipv4({10, 0, 0, 8}, 40'000)), OtherPlace);
  EXPECT_FALSE(table_.find(prefix(2))->is_local);
  EXPECT_EQ(table_.find(prefix(2))->source.address_text(), "10.0.0.9");
  EXPECT_FALSE(table_.find(prefix(3)));
  EXPECT_EQ(take(std::nullopt, kHere), Broken);
}

TEST_F(PeerTableTest, ForgetsWhoIsSilentOrHasGone) {
  EXPECT_EQ(announce(1, kHere, {.lease = std::chrono::hours(24)}), Heard);
  EXPECT_EQ(announce(2, kHere), Heard);
  EXPECT_EQ(announce(2, kHere, {.is_departure = true}), Heard);
  now_ += seconds(6);
  EXPECT_EQ(speak(2, kHere), Stranger);
  EXPECT_EQ(speak(1, kHere), Heard);
  now_ += PeerTable::kMaxLease + seconds(6);
  EXPECT_EQ(speak(1, kHere), Stranger) << "its endless lease was cut";
  EXPECT_EQ(announce(1, kElsewhere), Heard) << "a new one under that prefix";
}

TEST_F(PeerTableTest, AsksNewcomersForACertificateIfToldSo) {
  needs_identity_ = true;
  EXPECT_EQ(announce(1, kElsewhere), WithoutIdentity);
  EXPECT_EQ(announce(1, kElsewhere, {.has_identity = true, .lease = seconds(5)}), Heard);
}

TEST_F(PeerTableTest, AFloodOfOnePortLeavesOthersTheirShare) {
  int heard = 0;
  std::uint64_t who = 100;
  for (int ms = 0; ms < 10'000; ms += 2, now_ += milliseconds(2))
    heard += announce(++who, kElsewhere) == Heard ? 1 : 0;
  EXPECT_NEAR(heard, 64 + 16 * 10, 2);
  EXPECT_EQ(announce(++who, kElsewhere), PortRate);
  EXPECT_EQ(announce(1, PacketSource::ipv4({10, 0, 0, 9}, 40'001)), Heard);
  EXPECT_EQ(announce(2, kHere), Heard);
}

TEST_F(PeerTableTest, AFloodOfManyPortsLeavesOtherAddressesTheirShare) {
  std::uint64_t who = 100;
  int heard = 0;
  for (int ms = 0; ms < 20'000; ms += 2, now_ += milliseconds(2)) {
    const auto port = static_cast<std::uint16_t>(1024 + ms % 60'000);
    heard += announce(++who, PacketSource::ipv4({10, 0, 0, 9}, port)) == Heard ? 1 : 0;
    ASSERT_LE(table_.size(), PeerTable::kBoundsElsewhere.peers);
    ASSERT_LE(table_.buckets(), 1000U) << "they grow no faster than they refill";
  }
  EXPECT_GE(heard, 128 + 40 * 15);
  EXPECT_LE(heard, 128 + 40 * 20);
  EXPECT_EQ(announce(1, PacketSource::ipv4({10, 0, 0, 8}, 40'000)), Heard);
  EXPECT_EQ(announce(2, kHere), Heard);
  now_ += seconds(60);
  EXPECT_EQ(announce(3, kHere), Heard);
  EXPECT_EQ(table_.size(), 1U);
  EXPECT_LE(table_.buckets(), 2U);
}

TEST_F(PeerTableTest, AFloodOfManyAddressesLeavesThisMachineItsShare) {
  const auto source = [](std::uint64_t number) {
    return PacketSource::ipv4(
        {10, 1, static_cast<std::uint8_t>(number >> 8U), static_cast<std::uint8_t>(number)},
        40'000);
  };
  std::map<PacketVerdict, int> verdicts;
  std::uint64_t who = 0;
  for (int ms = 0; ms < 60'000; ++ms, now_ += milliseconds(1)) {
    ++who;
    ++verdicts[announce(who, source(who), {.lease = std::chrono::hours(1)})];
    ASSERT_LE(table_.size(), PeerTable::kMaxPeersElsewhere);
    ASSERT_LE(table_.buckets(), 2 * PeerTable::kMaxPeers);
  }
  EXPECT_GT(verdicts[OverallRate], 0);
  for (int i = 0; i < 32; ++i)
    EXPECT_EQ(announce(++who, kHere), Heard);
}

TEST_F(PeerTableTest, HoldsNoMoreThanItsBounds) {
  std::uint64_t who = 0;
  std::vector<PacketSource> sources = {kHere};
  const auto wait_for_tokens = [&] {
    now_ += seconds(4);
    for (std::uint64_t old = 1; old < sources.size(); ++old)  // all stay
      speak(old, sources.at(old));
  };
  const auto fill = [&](const PacketSource& source) {
    while (true) {
      const PacketVerdict verdict = announce(who + 1, source, {.lease = seconds(20)});
      if (verdict == AddressFull || verdict == Full)
        return verdict;
      if (verdict != Heard) {
        wait_for_tokens();
        continue;
      }
      ++who;
      sources.push_back(source);
    }
  };
  EXPECT_EQ(fill(kElsewhere), AddressFull);
  EXPECT_EQ(table_.size(), PeerTable::kBoundsElsewhere.peers);
  EXPECT_EQ(fill(PacketSource::ipv4({10, 0, 0, 10}, 1)), AddressFull);
  EXPECT_EQ(fill(PacketSource::ipv4({10, 0, 0, 11}, 1)), Full) << "elsewhere";
  EXPECT_EQ(table_.size(), PeerTable::kMaxPeersElsewhere);
  EXPECT_EQ(announce(++who, kHere), Heard);
}

TEST_F(PeerTableTest, TakesTheClientsOfThisMachineBackAtOnce) {
  std::uint64_t who = 0;
  for (std::uint16_t process = 0; process < 10; ++process)
    for (int i = 0; i < 50; ++i)
      ASSERT_EQ(announce(++who, PacketSource::ipv4({127, 0, 0, 1},
                                                   static_cast<std::uint16_t>(50'000 + process))),
                Heard)
          << who;
}

TEST_F(PeerTableTest, CountsTheAddressesOfThisMachineAsOne) {
  std::uint64_t who = 0;
  for (int ms = 0; ms < 60'000; ++ms, now_ += milliseconds(1)) {
    const auto port = static_cast<std::uint16_t>(1024 + ms);
    const auto host = static_cast<std::uint8_t>(1 + ms % 200);
    announce(++who, PacketSource::ipv4({127, 0, 0, host}, port), {.lease = seconds(15)});
    ASSERT_LE(table_.size(), PeerTable::kMaxPeersHere);
  }
  for (int i = 0; i < 64; ++i)
    EXPECT_EQ(announce(++who, kElsewhere), Heard);
}

TEST_F(PeerTableTest, AFloodOfManyPortsOfThisMachineLeavesFirstAskersTheirShare) {
  std::uint64_t who = 0;
  for (int ms = 0; ms < 60'000; ms += 2, now_ += milliseconds(2)) {
    const auto port = static_cast<std::uint16_t>(40'000 + ms / 2 % 256);
    announce(++who, PacketSource::ipv4({127, 0, 0, 1}, port), {.lease = seconds(15)});
    if (ms % 200 == 0) {
      const auto fresh = static_cast<std::uint16_t>(50'000 + ms / 200);
      ASSERT_EQ(announce(++who, PacketSource::ipv4({127, 0, 0, 1}, fresh)), Heard) << ms;
    }
  }
}

TEST_F(PeerTableTest, AFloodOfAnotherAddressOfThisMachineTakesNoPortFromFirstAskers) {
  std::uint64_t who = 0;
  for (int ms = 0; ms < 10'000; ms += 2, now_ += milliseconds(2))
    announce(++who,
             PacketSource::ipv4({127, 0, 0, 2}, static_cast<std::uint16_t>(40'000 + ms / 2 % 256)),
             {.lease = seconds(15)});
  for (std::uint16_t i = 0; i < 64; ++i)
    ASSERT_EQ(
        announce(++who, PacketSource::ipv4({127, 0, 0, 1}, static_cast<std::uint16_t>(40'000 + i))),
        Heard)
        << i;
}

TEST_F(PeerTableTest, APortThatAParticipantHasLeftIsTheNextOnes) {
  std::uint64_t who = 0;
  const auto newcomer = PacketSource::ipv4({127, 0, 0, 1}, 50'000);
  for (int ms = 0; ms < 20'000; ms += 2, now_ += milliseconds(2)) {
    const auto port = static_cast<std::uint16_t>(40'000 + ms / 2 % 256);
    announce(++who, PacketSource::ipv4({127, 0, 0, 2}, port), {.lease = seconds(15)});
    if (ms % 2'000 == 0) {
      ASSERT_EQ(announce(++who, newcomer), Heard) << ms;
      ASSERT_EQ(announce(who, newcomer, {.is_departure = true}), Heard);
    }
  }
}

TEST_F(PeerTableTest, TakesShortLivedClientsOfOneHost) {
  std::uint64_t who = 0;
  for (int i = 0; i < 64; ++i)  // at once
    EXPECT_EQ(
        announce(++who, PacketSource::ipv4({10, 0, 0, 9}, static_cast<std::uint16_t>(50'000 + i))),
        Heard);
  for (int ms = 0; ms < 60'000; ms += 50, now_ += milliseconds(50)) {  // 20 a second, half killed
    const auto source =
        PacketSource::ipv4({10, 0, 0, 9}, static_cast<std::uint16_t>(30'000 + ms / 50));
    ASSERT_EQ(announce(++who, source), Heard) << ms;
    if (who % 2 == 0) {
      ASSERT_EQ(announce(who, source, {.is_departure = true}), Heard);
    }
  }
}

TEST_F(PeerTableTest, LimitsTheAnnouncementsOfAKnownParticipant) {
  int heard = 0;
  for (int ms = 0; ms < 10'000; ms += 2, now_ += milliseconds(2))
    heard += announce(1, kHere) == Heard ? 1 : 0;
  EXPECT_NEAR(heard, 8 + 4 * 10, 2);
  while (announce(1, kHere) == Heard) {
  }
  EXPECT_EQ(announce(1, kHere), PeerRate);
  EXPECT_EQ(speak(1, kHere), Heard);
}

}  // namespace
}  // namespace kinship::dds::peer_table_test
