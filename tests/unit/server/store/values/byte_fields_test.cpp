#include "server/store/values/byte_fields.hpp"

#include <gtest/gtest.h>

namespace kinship {
namespace {

/// A made-up value to which a format brought a field.
struct Crate {
  std::uint64_t bottles = 0;
  std::string colour = "unpainted";
};

}  // namespace

template <>
inline constexpr std::tuple kFieldsOf<Crate>{Field{"bottles", &Crate::bottles},
                                             Field{"colour", &Crate::colour, since(2)}};

namespace store::byte_fields_test {
namespace {

static_assert(newest_format(kFieldsOf<Crate>) == 2);

TEST(ByteFields, WhatAFormatLacksKeepsItsDefault) {
  ByteWriter older, newer;
  older.add(std::uint64_t{6});
  add_value(newer, Crate{12, "red"});
  ByteReader in(older.bytes());
  const auto before = read_value<Crate>(in, 1);
  EXPECT_EQ(before.bottles, 6U);
  EXPECT_EQ(before.colour, "unpainted");
  EXPECT_TRUE(in.at_end());
  ByteReader again(newer.bytes());
  const auto now = read_value<Crate>(again, 2);
  EXPECT_EQ(now.bottles, 12U);
  EXPECT_EQ(now.colour, "red");
}

}  // namespace
}  // namespace store::byte_fields_test
}  // namespace kinship
