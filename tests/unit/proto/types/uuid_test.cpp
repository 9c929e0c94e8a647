#include "proto/types/uuid.hpp"

#include <gtest/gtest.h>

#include <set>

namespace kinship::uuid_test {
namespace {

TEST(Uuid, RoundTripsThroughText) {
  const Uuid uuid = Uuid::random();
  EXPECT_EQ(Uuid::parse(uuid.text()), uuid);
  EXPECT_EQ(uuid.text().size(), 36U);
  EXPECT_EQ(uuid.text()[14], '4');
}

TEST(Uuid, RandomOnesDiffer) {
  std::set<Uuid> seen;
  for (int i = 0; i < 1000; ++i)
    seen.insert(Uuid::random());
  EXPECT_EQ(seen.size(), 1000U);
}

TEST(Uuid, RefusesOtherForms) {
  EXPECT_FALSE(Uuid::parse(""));
  EXPECT_FALSE(Uuid::parse("00000000000000000000000000000000"));
  EXPECT_FALSE(Uuid::parse("00000000-0000-4000-8000-00000000000x"));
  EXPECT_FALSE(Uuid::parse("000000000-000-4000-8000-000000000000"));
}

}  // namespace
}  // namespace kinship::uuid_test
