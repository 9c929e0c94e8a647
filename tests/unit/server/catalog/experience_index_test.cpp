#include "server/catalog/experience_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "tests/unit/server/fitting/fit_fixture.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::catalog {
namespace {

class Books : public fitting::FitDistribution {
 protected:
  static ExperienceKey key(std::uint32_t bytes = kDefaultExperienceBytes) {
    return {"shelf", {}, 0, bytes};
  }
  static std::future<SharedChoice> ask(ExperienceIndex& experience_index,
                                       const ExperienceKey& key) {
    const auto promise = std::make_shared<std::promise<SharedChoice>>();
    experience_index.ask(key,
                         [promise](const SharedChoice& choice) { promise->set_value(choice); });
    return promise->get_future();
  }
  static bool has(const SharedChoice& choice, const Uuid& path) {
    return std::any_of(choice->paths.begin(), choice->paths.end(),
                       [&](const auto& one) { return one->path == path; });
  }
};

TEST_F(Books, WhoAsksAfterARetirementGetsWhatWasReadAfterIt) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 3, 1);
  report(attempts);
  ExperienceIndex* asked = nullptr;
  std::future<SharedChoice> later;
  store::TroubledStore store(*store_, [&] {
    if (later.valid())
      return;
    ASSERT_TRUE(store_->retire_path(attempts[1].report_uuid));
    asked->forget("shelf");
    later = ask(*asked, key());
  });
  ExperienceIndex experience_index(store, registry_);
  asked = &experience_index;
  const SharedChoice before = ask(experience_index, key()).get();
  ASSERT_TRUE(before);
  EXPECT_TRUE(has(before, attempts[1].report_uuid));
  EXPECT_EQ(later.get()->paths.size(), 2U);
  ASSERT_TRUE(experience_index.find(key()));
  EXPECT_EQ(experience_index.find(key())->paths.size(), 2U);
}

TEST_F(Books, HoldOneChoiceForAllWhoAsk) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  ExperienceIndex experience_index(*store_, registry_, {.max_choices = 2, .max_waiters = 10});
  EXPECT_FALSE(experience_index.find(key()));
  const SharedChoice choice = ask(experience_index, key()).get();
  EXPECT_EQ(ask(experience_index, key()).get(), choice);
  EXPECT_EQ(experience_index.find(key()), choice);
  EXPECT_NE(ask(experience_index, key(5000)).get(), choice);
  EXPECT_TRUE(ask(experience_index, key(6000)).get());
  EXPECT_FALSE(experience_index.find(key()))
      << "of three the one that was not asked for longest is gone";
  EXPECT_TRUE(experience_index.find(key(5000)));
}

TEST_F(Books, HoldNoMoreBytesThanPathsMayTake) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  constexpr std::size_t kOfAChoice = 3 * kExperiencePoses * sizeof(Eigen::Isometry3d);
  for (const std::size_t choices : {1U, 2U}) {
    ExperienceIndex experience_index(*store_, registry_,
                                     {.paths = {.bytes = choices * kOfAChoice * 5 / 4}});
    EXPECT_TRUE(ask(experience_index, key()).get());
    EXPECT_TRUE(ask(experience_index, key(5000)).get());
    EXPECT_EQ(experience_index.find(key()) != nullptr, choices == 2);
    EXPECT_TRUE(experience_index.find(key(5000)));
    EXPECT_GT(experience_index.bytes_of_paths(), kOfAChoice);
  }
}

TEST_F(Books, AnswerWhoWaitsWhenTheyStop) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  std::promise<void> begun, end;
  store::TroubledStore store(*store_, [&, held = false]() mutable {
    if (std::exchange(held, true))
      return;
    begun.set_value();
    end.get_future().wait();
  });
  ExperienceIndex experience_index(store, registry_);
  bool is_answered = false;
  experience_index.ask(key(), [&](const SharedChoice& choice) {
    EXPECT_FALSE(choice);
    is_answered = true;
    end.set_value();  // the thread that stop() waits for
  });
  begun.get_future().wait();
  experience_index.stop();
  EXPECT_TRUE(is_answered);
  EXPECT_FALSE(ask(experience_index, key()).get());
}

}  // namespace
}  // namespace kinship::catalog
