#include "server/catalog/distribution_cache.hpp"

#include <gtest/gtest.h>

#include "server/catalog/fetch_reply.hpp"

namespace kinship::catalog::distribution_cache_test {
namespace {

Digest id(std::uint8_t number) {
  Digest digest;
  digest.bytes[31] = number;
  return digest;
}

DistributionCache::Entry entry(int components) {
  constexpr Eigen::Index kDof = 4;
  Distribution distribution;
  distribution.mixture =
      Mixture(Eigen::VectorXd::Constant(components, 1.0 / components),
              Eigen::MatrixXd::Zero(kDof, components),
              std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(components),
                                           Eigen::MatrixXd::Identity(kDof, kDof)));
  return {.reply = {.reply = with_distribution(std::move(distribution))}};
}

TEST(DistributionCache, ForgetsTheOneNotUsedForLongest) {
  DistributionCache cache({.entries = 2});
  cache.put(id(1), entry(1));
  cache.put(id(2), entry(1));
  ASSERT_NE(cache.find(id(1)), nullptr);
  cache.put(id(3), entry(1));
  EXPECT_EQ(cache.find(id(2)), nullptr);
  EXPECT_NE(cache.find(id(1)), nullptr);
  EXPECT_NE(cache.find(id(3)), nullptr);
}

TEST(DistributionCache, IsBoundedBySize) {
  DistributionCache cache({.entries = 100, .bytes = 20'000});
  for (std::uint8_t i = 0; i < 10; ++i)
    cache.put(id(i), entry(8));
  EXPECT_LE(cache.bytes(), 20'000U);
  EXPECT_LT(cache.size(), 10U);
  EXPECT_NE(cache.find(id(9)), nullptr);
}

TEST(DistributionCache, OneThatIsTooLargeIsKeptAlone) {
  DistributionCache cache({.entries = 100, .bytes = 1000});
  cache.put(id(1), entry(8));
  cache.put(id(2), entry(8));
  EXPECT_EQ(cache.size(), 1U);
  EXPECT_NE(cache.find(id(2)), nullptr);
}

TEST(DistributionCache, ANewerOneTakesThePlaceOfTheOlder) {
  DistributionCache cache({});
  cache.put(id(1), entry(1));
  const std::size_t bytes = cache.bytes();
  DistributionCache::Entry newer = entry(1);
  newer.version.changes = 5;
  cache.put(id(1), newer);
  EXPECT_EQ(cache.size(), 1U);
  EXPECT_EQ(cache.bytes(), bytes);
  EXPECT_EQ(cache.find(id(1))->version.changes, 5U);
}

TEST(DistributionCache, ForgetsWhatItIsToldTo) {
  DistributionCache cache({});
  cache.put(id(1), entry(1));
  cache.erase(id(1));
  cache.erase(id(2));
  EXPECT_EQ(cache.find(id(1)), nullptr);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(DistributionCache, OtherAdviceReplacesOnlyTheReplyItWasMadeFrom) {
  DistributionCache cache({});
  const DistributionCache::Entry first = entry(1), second = entry(1);
  cache.put(id(1), first);
  cache.replace(id(1), second.reply.reply, {.reply = second.reply.reply, .version = 7});
  EXPECT_EQ(cache.find(id(1))->reply.reply, first.reply.reply);
  cache.replace(id(1), first.reply.reply, {.reply = second.reply.reply, .version = 7});
  EXPECT_EQ(cache.find(id(1))->reply.version, 7U);
  EXPECT_EQ(cache.size(), 1U);
}

}  // namespace
}  // namespace kinship::catalog::distribution_cache_test
