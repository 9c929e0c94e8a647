#include "proto/types/rules.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace kinship {
namespace rules_test {

struct Numbers {
  std::int64_t since_ms = 0;
  int tries = 3;
  std::uint64_t paths = 0;
  double time_s = 0;
  double share = 0.5;
  double ratio = 2;
  std::map<std::string, double> held = {};
  std::vector<std::string> words = {};
};

constexpr std::tuple kWithoutElementLimit{Field{"words", &Numbers::words, {.limit = 2}}};

}  // namespace rules_test

template <>
inline constexpr std::tuple kFieldsOf<rules_test::Numbers>{
    Field{"since_ms", &rules_test::Numbers::since_ms, {.min = 0}},
    Field{"tries", &rules_test::Numbers::tries, {.min = 2}},
    Field{"paths", &rules_test::Numbers::paths},
    Field{"time_s", &rules_test::Numbers::time_s, {.min = 0}},
    Field{"share", &rules_test::Numbers::share, {.min = 0, .max = 1}},
    Field{"ratio", &rules_test::Numbers::ratio, {.min = 1}},
    Field{"held", &rules_test::Numbers::held, {.limit = 2}},
    Field{"words", &rules_test::Numbers::words, {.limit = 2, .element_limit = 4}}};

namespace rules_test {
namespace {

static_assert(limits_listed_texts(kFieldsOf<Numbers>));
static_assert(!limits_listed_texts(kWithoutElementLimit));

std::string complaint(const Numbers& numbers) {
  Rules rules;
  check_fields(numbers, rules);
  return rules.broken() ? rules.broken()->message : "";
}

TEST(Rules, AMinimumAloneHoldsForIntegersToo) {
  EXPECT_EQ(complaint({}), "");
  EXPECT_EQ(complaint({.since_ms = -1}), "since_ms: -1 is negative");
  EXPECT_EQ(complaint({.tries = 1}), "tries: 1 is less than 2");
  EXPECT_EQ(complaint({.tries = 2, .paths = ~std::uint64_t{0}}), "");
}

TEST(Rules, RealNumbersAreFiniteAndWithinTheirLimits) {
  EXPECT_EQ(complaint({.time_s = -0.5}), "time_s: -0.5 is negative");
  EXPECT_EQ(complaint({.time_s = std::nan("")}), "time_s: nan is not finite");
  EXPECT_EQ(complaint({.share = 1.5}), "share: 1.5 is not between 0 and 1");
  EXPECT_EQ(complaint({.ratio = 0.5}), "ratio: 0.5 is less than 1");
  EXPECT_EQ(complaint({.ratio = std::nan("")}), "ratio: nan is not finite");
}

TEST(Rules, ElementsOfListsAndMapsAreCounted) {
  EXPECT_EQ(complaint({.held = {{"a", 0}, {"b", 0}, {"c", 0}}}), "held: 3 exceeds 2");
  EXPECT_EQ(complaint({.words = {"a", "b", "c"}}), "words: 3 exceeds 2");
  EXPECT_NE(complaint({.words = {"abcde"}}), "");
  EXPECT_EQ(complaint({.words = {"abcd"}}), "");
}

}  // namespace
}  // namespace rules_test
}  // namespace kinship
