// The experience of a task in a fetch: asked for, answered, and what is refused of it.

#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/fetch_codec.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::experience_codec_test {
namespace {

constexpr std::uint64_t kSeed = 34;

TaskExperience experience_of(int paths, int poses) {
  test::RandomValues values(kSeed);
  TaskExperience experience;
  experience.revision = 7;
  experience.paths_known = 5000;
  for (int i = 0; i < paths; ++i) {
    PosePath path{values.digest(), Uuid::random(), {}};
    for (int j = 0; j < poses; ++j)
      path.poses.push_back(values.pose());
    experience.paths.push_back(path);
  }
  return experience;
}

FetchReply reply_with(TaskExperience experience) {
  FetchReply reply;
  reply.status = FetchStatus::Pending;
  reply.experience = std::move(experience);
  return reply;
}

std::string fault_of(TaskExperience experience) {
  return encode({}, reply_with(std::move(experience))).error().message;
}

TEST(ExperienceCodec, WhatIsAskedForComesBack) {
  FetchRequest written;
  written.task = "shelf_pick";
  written.experience_bytes = kDefaultExperienceBytes;
  written.known_experience = std::numeric_limits<std::uint64_t>::max();
  const auto read = decode(encode({}, written)->wire).value_or_throw();
  EXPECT_EQ(read.experience_bytes, written.experience_bytes);
  EXPECT_EQ(read.known_experience, written.known_experience);
  auto message = encode({}, written).value_or_throw();
  message.wire.experience_bytes = kMaxExperienceBytes + 1;
  EXPECT_EQ(decode(message.wire).error().message,
            "experience_bytes: 1048577 is not between 0 and 1048576");
}

TEST(ExperienceCodec, PathsComeBackAsPreciseAsFloats) {
  const TaskExperience written = experience_of(3, kExperiencePoses);
  const auto message = encode({}, reply_with(written)).value_or_throw();
  const FetchReply read = decode(message.wire).value_or_throw();
  ASSERT_TRUE(read.experience);
  EXPECT_EQ(read.experience->revision, written.revision);
  EXPECT_EQ(read.experience->paths_known, written.paths_known);
  ASSERT_EQ(read.experience->paths.size(), written.paths.size());
  for (std::size_t i = 0; i < written.paths.size(); ++i) {
    EXPECT_EQ(read.experience->paths[i].source, written.paths[i].source);
    EXPECT_EQ(read.experience->paths[i].path, written.paths[i].path);
    ASSERT_EQ(read.experience->paths[i].poses.size(), written.paths[i].poses.size());
    for (std::size_t j = 0; j < written.paths[i].poses.size(); ++j)
      EXPECT_TRUE(read.experience->paths[i].poses[j].isApprox(written.paths[i].poses[j], 1e-6));
  }
}

TEST(ExperienceCodec, NoneIsNotAnEmptyOne) {
  FetchReply reply = reply_with(experience_of(0, 2));
  auto message = encode({}, reply).value_or_throw();
  EXPECT_TRUE(decode(message.wire)->experience);
  reply.experience.reset();
  message = encode({}, reply).value_or_throw();
  EXPECT_FALSE(decode(message.wire)->experience);
}

TEST(ExperienceCodec, APathHas2To256Poses) {
  EXPECT_TRUE(encode({}, reply_with(experience_of(1, 2))));
  EXPECT_TRUE(encode({}, reply_with(experience_of(1, 256))));
  EXPECT_NE(fault_of(experience_of(1, 1)).find("poses: 1 is not between 2 and 256"),
            std::string::npos);
  EXPECT_NE(fault_of(experience_of(1, 257)).find("poses: 257 is not between 2 and 256"),
            std::string::npos);
  auto message = encode({}, reply_with(experience_of(1, 2))).value_or_throw();
  auto& poses = message.wire.experience._buffer[0].paths._buffer[0].poses;
  poses._length = 7;
  EXPECT_NE(decode(message.wire).error().message.find("poses: 1 is not between 2 and 256"),
            std::string::npos);
  poses._length = 13;
  EXPECT_NE(decode(message.wire).error().message.find("13 numbers are not a multiple of 7"),
            std::string::npos);
}

TEST(ExperienceCodec, BadPosesAreRefused) {
  TaskExperience far = experience_of(2, 2);
  far.paths[1].poses[1].translation().x() = 1001;
  EXPECT_NE(fault_of(far).find("coordinate 1001 m exceeds 1000 m"), std::string::npos);
  auto message = encode({}, reply_with(experience_of(2, 2))).value_or_throw();
  float* const numbers = message.wire.experience._buffer[0].paths._buffer[1].poses._buffer;
  numbers[6] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(decode(message.wire).error().message.find("not finite"), std::string::npos);
  numbers[6] = 3;
  EXPECT_FALSE(decode(message.wire));
}

TEST(ExperienceCodec, CountsAreBounded) {
  TaskExperience experience = experience_of(2, 2);
  experience.paths_known = 1;
  EXPECT_EQ(fault_of(experience), "experience: 2 paths of 1 known");
  experience = experience_of(0, 2);
  experience.revision = 0;
  EXPECT_EQ(fault_of(experience), "experience: revision 0");
  experience = experience_of(1, 2);
  experience.paths.resize(kMaxExperiencePaths + 1, experience.paths[0]);
  EXPECT_EQ(fault_of(experience), "experience: paths: 4097 exceeds 4096");
}

TEST(ExperienceCodec, WhatItCountsIsWhatAMessageHas) {
  const auto bytes = [](int paths) {
    return encode({}, reply_with(experience_of(paths, kExperiencePoses)))->arena->bytes();
  };
  EXPECT_LE(bytes(11) - bytes(1), 10 * experience_bytes(kExperiencePoses));
}

}  // namespace
}  // namespace kinship::codec::experience_codec_test
