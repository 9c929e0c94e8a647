#include "client/experiments/pipeline/study_description.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "client/experiments/pipeline/study_session.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::study_description_test {
namespace {

TEST(StudyDescription, AQuickRunSaysTheInstancesThatItLearnsFrom) {
  const Study& study = *find_studies("planar").front();
  ASSERT_GT(study.learning_instances, kQuickLearning);
  RunOptions options;
  options.models = test::source_dir() + "/robots/models";
  const auto fleet = load_fleet(study, options.models);
  const auto said = [&] {
    const std::string text = describe_study(study, fleet, learning_instances(study, options));
    return nlohmann::json::parse(text).at("learning_instances").get<std::uint32_t>();
  };
  EXPECT_EQ(said(), study.learning_instances);
  options.quick = true;
  EXPECT_EQ(said(), kQuickLearning);
  options.learning = 5;
  EXPECT_EQ(said(), 5U);
}

}  // namespace
}  // namespace kinship::experiments::study_description_test
