#include "proto/types/enum_text.hpp"

#include <gtest/gtest.h>

namespace kinship::enum_text_test {
namespace {

TEST(EnumText, EveryWordIsReadBack) {
  for (const Outcome outcome : {Outcome::Solved, Outcome::Timeout, Outcome::Failed})
    EXPECT_EQ(parse_word<Outcome>(to_text(outcome)).value(), outcome);
  for (const SamplingMode arm :
       {SamplingMode::Guided, SamplingMode::Control, SamplingMode::Uniform})
    EXPECT_EQ(parse_word<SamplingMode>(to_text(arm)).value(), arm);
  for (const DistributionState state :
       {DistributionState::Ready, DistributionState::Failed, DistributionState::Thin})
    EXPECT_EQ(parse_word<DistributionState>(to_text(state)).value(), state);
}

TEST(EnumText, RefusalListsTheAllowedWords) {
  const auto outcome = parse_word<Outcome>("Solved");
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(outcome.error().message, "outcome: 'Solved' is not one of solved, timeout, failed");
  EXPECT_FALSE(parse_word<SamplingMode>(""));
}

TEST(EnumText, ValueOutsideTheEnumIsACallersBug) {
  EXPECT_THROW(to_text(static_cast<SamplingMode>(7)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::enum_text_test
