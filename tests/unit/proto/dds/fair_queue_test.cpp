#include "proto/dds/fair_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
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
  using Queue = FairQueue<int>;
  using Time = Queue::Time;
  static Time at(int s) { return Time(std::chrono::seconds(s)); }

  bool offer(std::uint8_t from, std::uint64_t number, Time held_until = Queue::kNow) {
    const codec::Head head{client(from), number};
    const std::string name = head.client_id.text();
    const auto opening = queue_.opening_for(name, head);
    if (opening)
      queue_.push(*opening, static_cast<int>(number), held_until);
    return opening.has_value();
  }
  /// Who is served, in order.
  std::vector<int> clients(Time now = Queue::kNever) {
    std::vector<int> served;
    while (const auto next = queue_.pop(now))
      served.push_back(next->first.client_id.bytes.back());
    return served;
  }
  FairQueue<int> queue_{kCapacity};
};

TEST_F(FairQueueTest, ServesClientsInTurnAndEachInOrder) {
  for (std::uint64_t number = 1; number <= 3; ++number)
    offer(1, number);
  offer(2, 1);
  EXPECT_EQ(queue_.pop(Queue::kNever)->first, (codec::Head{client(1), 1}));
  EXPECT_EQ(queue_.pop(Queue::kNever)->first, (codec::Head{client(2), 1}));
  EXPECT_EQ(queue_.pop(Queue::kNever)->first, (codec::Head{client(1), 2}));
  EXPECT_EQ(queue_.pop(Queue::kNever)->first, (codec::Head{client(1), 3}));
  EXPECT_FALSE(queue_.pop(Queue::kNever));
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

TEST_F(FairQueueTest, WhatIsHeldIsPassedOverUntilItsTimeComes) {
  EXPECT_EQ(queue_.next(), Queue::kNever);
  offer(1, 1, at(5));
  offer(2, 1, at(3));
  EXPECT_EQ(queue_.next(), at(3));
  offer(1, 2);  // of the same client, which need not wait for the other
  offer(3, 1);
  EXPECT_EQ(queue_.next(), Queue::kNow);
  EXPECT_EQ(clients(at(2)), (std::vector<int>{1, 3}));
  EXPECT_EQ(queue_.next(), at(3));
  EXPECT_EQ(clients(at(3)), (std::vector<int>{2}));
  EXPECT_TRUE(queue_.holds_some());
  EXPECT_EQ(clients(at(5)), (std::vector<int>{1}));
  EXPECT_FALSE(queue_.holds_some());
  EXPECT_EQ(queue_.next(), Queue::kNever);
}

TEST_F(FairQueueTest, WhatIsHeldCanBeReleased) {
  for (std::uint8_t from = 1; from <= 3; ++from)
    offer(from, from, at(5));
  queue_.release(client(1).text(), {client(1), 7});  // nothing of that number
  queue_.release(client(1).text(), {client(1), 1});
  EXPECT_EQ(clients(at(1)), (std::vector<int>{1}));
  queue_.release_if([](const codec::Head&, int number) { return number == 3; });
  EXPECT_EQ(clients(at(1)), (std::vector<int>{3}));
  EXPECT_TRUE(queue_.holds_some());
  queue_.release(client(2).text(), {client(2), 2});
  EXPECT_FALSE(queue_.holds_some());
  EXPECT_EQ(clients(at(1)), (std::vector<int>{2}));
}

TEST_F(FairQueueTest, WhatIsHeldTakesRoomAndGivesWayLikeAllElse) {
  for (std::uint64_t number = 1; number <= kCapacity; ++number)
    EXPECT_TRUE(offer(1, number, at(5)));
  EXPECT_FALSE(offer(1, 9, at(5)));
  for (std::uint64_t number = 1; number <= kCapacity / 2; ++number)
    EXPECT_TRUE(offer(2, number));
  EXPECT_EQ(queue_.size(), kCapacity);
  EXPECT_EQ(clients(at(1)), (std::vector<int>(kCapacity / 2, 2)));
  EXPECT_TRUE(queue_.holds_some());
  EXPECT_EQ(clients(at(5)), (std::vector<int>(kCapacity / 2, 1)));
  EXPECT_FALSE(queue_.holds_some());
}

}  // namespace
}  // namespace kinship::dds::fair_queue_test
