#include "proto/dds/fair_queue.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace kinship::dds::fair_queue_test {
namespace {

constexpr std::size_t kCapacity = 8;

Uuid client(std::uint8_t number) {
  Uuid id;
  id.bytes.back() = number;
  return id;
}

class FairQueueTest : public testing::Test {
 protected:
  bool offer(std::uint8_t from, std::uint64_t number) {
    const codec::Head head{client(from), number};
    const std::string name = head.client_id.text();
    const auto opening = queue_.opening_for(name, head);
    if (opening)
      queue_.push(*opening, static_cast<int>(number));
    return opening.has_value();
  }
  /// Who is served, in order.
  std::vector<int> clients() {
    std::vector<int> served;
    while (const auto next = queue_.pop())
      served.push_back(next->first.client_id.bytes.back());
    return served;
  }
  FairQueue<int> queue_{kCapacity};
};

TEST_F(FairQueueTest, ServesClientsInTurnAndEachInOrder) {
  for (std::uint64_t number = 1; number <= 3; ++number)
    offer(1, number);
  offer(2, 1);
  EXPECT_EQ(queue_.pop()->first, (codec::Head{client(1), 1}));
  EXPECT_EQ(queue_.pop()->first, (codec::Head{client(2), 1}));
  EXPECT_EQ(queue_.pop()->first, (codec::Head{client(1), 2}));
  EXPECT_EQ(queue_.pop()->first, (codec::Head{client(1), 3}));
  EXPECT_FALSE(queue_.pop());
  EXPECT_EQ(queue_.size(), 0U);
}

TEST_F(FairQueueTest, AFloodPushesNobodyElseOut) {
  EXPECT_TRUE(offer(1, 1));
  for (std::uint64_t number = 1; number <= 1000; ++number)
    EXPECT_EQ(offer(2, number), number < kCapacity) << number;
  EXPECT_TRUE(offer(3, 1));  // in the place of one of the flood
  EXPECT_TRUE(offer(3, 2));
  EXPECT_EQ(queue_.size(), kCapacity);
  EXPECT_EQ(clients(), (std::vector<int>{1, 2, 3, 2, 3, 2, 2, 2}));
}

TEST_F(FairQueueTest, WhatIsSentAgainWaitsOnce) {
  EXPECT_TRUE(offer(1, 1));
  EXPECT_FALSE(offer(1, 1));
  EXPECT_TRUE(offer(2, 1));
  EXPECT_EQ(clients(), (std::vector<int>{1, 2}));
  EXPECT_TRUE(offer(1, 1));
}

TEST_F(FairQueueTest, WhoIsGivenRoomAndDoesNotTakeItPushesNobodyOut) {
  for (std::uint64_t number = 1; number <= kCapacity; ++number)
    EXPECT_TRUE(offer(1, number));
  const codec::Head head{client(2), 1};
  EXPECT_TRUE(queue_.opening_for(head.client_id.text(), head));
  EXPECT_EQ(queue_.size(), kCapacity);
  EXPECT_EQ(clients(), (std::vector<int>(kCapacity, 1)));
}

TEST_F(FairQueueTest, NobodyHasToGoForWhoHasAsMany) {
  for (std::uint8_t from = 1; from <= kCapacity; ++from)
    EXPECT_TRUE(offer(from, 1));
  EXPECT_FALSE(offer(1, 2));
  EXPECT_FALSE(offer(kCapacity + 1, 1));
}

}  // namespace
}  // namespace kinship::dds::fair_queue_test
