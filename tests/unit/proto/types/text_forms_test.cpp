#include "proto/types/enum_text.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <vector>

#include "proto/types/attempt_filter.hpp"
#include "proto/types/duration_text.hpp"
#include "proto/types/nearest_name.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::text_forms_test {
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

TEST(EnumText, AGuideIsTheSumOfItsParts) {
  for (int index = 0; index <= static_cast<int>(Guide::All); ++index) {
    const auto guide = static_cast<Guide>(index);
    std::string parts;
    const auto add = [&](bool has, const std::string& part) {
      if (has)
        parts += (parts.empty() ? "" : "+") + part;
    };
    add(has_recall(guide), "recall");
    add(has_retreat(guide), "retreat");
    add(has_ways(guide), "ways");
    add(has_mixture(guide), "mixture");
    EXPECT_EQ(to_text(guide), parts.empty() ? "none" : parts);
    EXPECT_EQ(parse_word<Guide>(to_text(guide)).value(), guide);
    EXPECT_EQ(has_recall(guide) ? with_recall(without_recall(guide)) : without_recall(guide),
              guide);
  }
  EXPECT_EQ(kLastOf<Guide>, Guide::All);
  EXPECT_EQ(with_recall(Guide::Ways), Guide::RecallWays);
  EXPECT_EQ(without_recall(Guide::All), Guide::RetreatWaysMixture);
}

TEST(EnumText, RefusalListsTheAllowedWords) {
  const auto outcome = parse_word<Outcome>("Solved");
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(outcome.error().message, "outcome: 'Solved' is not one of solved, timeout, failed");
  EXPECT_FALSE(parse_word<SamplingMode>(""));
}

TEST(AttemptFilter, IsReadBackFromItsText) {
  EXPECT_EQ(to_text(AttemptFilter{}), "");
  for (const AttemptFilter& filter :
       {AttemptFilter{}, AttemptFilter{.outcome = OutcomeFilter::Timeout},
        AttemptFilter{OutcomeFilter::Unsolved, 1'700'000'000'000, AttemptOrder::Slowest}})
    EXPECT_EQ(attempt_filter_from_text(to_text(filter)).value(), filter) << to_text(filter);
  const auto message = [](const char* text) {
    const auto filter = attempt_filter_from_text(text);
    return filter ? "" : filter.error().message;
  };
  EXPECT_EQ(message("outcome=lost"),
            "outcome: 'lost' is not one of all, solved, unsolved, timeout, failed");
  EXPECT_EQ(message("since_ms=-4"), "since_ms: '-4' is no time");
  EXPECT_EQ(message("since_ms="), "since_ms: '' is no time");
  EXPECT_EQ(message("order=newest,slow"),
            "filter of attempts: 'slow' is not one of outcome, since_ms, order");
}

TEST(EnumText, ValueOutsideTheEnumIsACallersBug) {
  EXPECT_THROW(to_text(static_cast<SamplingMode>(7)), std::invalid_argument);
}

TEST(DurationText, HasThreeDigitsInTheUnitThatFits) {
  EXPECT_EQ(duration_text(0), "0 s");
  EXPECT_EQ(duration_text(2.5), "2.50 s");
  EXPECT_EQ(duration_text(75.04), "75.0 s");
  EXPECT_EQ(duration_text(1234.5), "1234 s");
  EXPECT_EQ(duration_text(0.4123), "412 ms");
  EXPECT_EQ(duration_text(0.00312), "3.12 ms");
  EXPECT_EQ(duration_text(85.12e-6), "85.1 µs");
  EXPECT_EQ(duration_text(4e-8), "0.04 µs");
}

TEST(DurationText, RoundsIntoTheNextUnit) {
  EXPECT_EQ(duration_text(0.99951), "1.00 s");
  EXPECT_EQ(duration_text(0.9994), "999 ms");
  EXPECT_EQ(duration_text(0.0099951), "10.0 ms");
}

TEST(NumberText, IsShortAndReadsBack) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-3), "-3");
  for (const double value : {1.0 / 3, -1e-300, std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value);
}

TEST(NumberText, NamesWhatIsNotFinite) {
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(TimeText, IsUtcToTheSecond) {
  EXPECT_EQ(time_text(std::int64_t{0}), "1970-01-01T00:00:00Z");
  EXPECT_EQ(time_text(std::int64_t{1'795'226'587'999}), "2026-11-21T02:03:07Z");
  EXPECT_EQ(time_text(std::chrono::sys_seconds(std::chrono::seconds(1'795'226'587))),
            "2026-11-21T02:03:07Z");
}

TEST(TimeText, BeforeNineteenSeventyRoundsDownToo) {
  EXPECT_EQ(time_text(std::int64_t{-1}), "1969-12-31T23:59:59Z");
}

TEST(EditDistance, CountsLettersPutInTakenOutChangedOrSwapped) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("lsit", "list"), 1U);
  EXPECT_EQ(edit_distance("ab", "bca"), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("list", "list"), 0U);
}

TEST(NearestName, IsNeverTheWordItself) {
  EXPECT_EQ(suggestion("--sto", std::vector<std::string>{"--sto", "--store"}),
            " (did you mean '--store'?)");
}

TEST(Suggestion, IsTheNearestName) {
  const std::vector<std::string> names = {"register", "list", "show", "check"};
  EXPECT_EQ(suggestion("regsiter", names), " (did you mean 'register'?)");
  EXPECT_EQ(suggestion("lsit", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("lost", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("last", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("lo", names), "");
  EXPECT_EQ(suggestion("lists", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("frobnicate", names), "");
  EXPECT_EQ(suggestion("list", {}), "");
}

}  // namespace
}  // namespace kinship::text_forms_test
