#include "server/store/values/scene_blob.hpp"

#include <gtest/gtest.h>

#include "proto/types/pose.hpp"
#include "server/store/values/compression.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::store::scene_blob_test {
namespace {

constexpr std::uint64_t kSeed = 51;

std::optional<RecordedScene> decode(const SceneBlob& blob) {
  return decode_scene(blob.size, static_cast<std::int64_t>(blob.encoding), blob.bytes);
}

std::vector<std::uint8_t> plain(const SceneBlob& blob) {
  if (blob.encoding == SceneEncoding::Plain)
    return blob.bytes;
  return decompress(blob.bytes, static_cast<std::size_t>(blob.size)).value();
}

TEST(SceneBlob, EverySceneComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < 100; ++i) {
    const RecordedScene written = values.recorded_scene(30);
    const auto read = decode(encode_scene(written));
    ASSERT_TRUE(read) << i;
    EXPECT_EQ(content_digest(*read), content_digest(written));
    ASSERT_EQ(read->objects.size(), written.objects.size());
    for (std::size_t n = 0; n < written.objects.size(); ++n) {
      EXPECT_EQ(read->objects[n].name, written.objects[n].name);
      EXPECT_EQ(to_numbers(read->objects[n].shape).sizes,
                to_numbers(written.objects[n].shape).sizes);
      EXPECT_EQ(read->objects[n].T_task_object.translation(),
                written.objects[n].T_task_object.translation());
    }
    EXPECT_EQ(read->allowed_collisions, written.allowed_collisions);
    ASSERT_EQ(read->constraint.has_value(), written.constraint.has_value());
    if (written.constraint) {
      EXPECT_EQ(read->constraint->bounds, written.constraint->bounds);  // infinite ones too
    }
  }
}

TEST(SceneBlob, ASceneOfEqualThingsIsCompressed) {
  RecordedScene scene;
  scene.objects.assign(30, {"shelf_board", BoxShape{{1, 1, 0.02}}});
  const SceneBlob blob = encode_scene(scene);
  EXPECT_EQ(blob.encoding, SceneEncoding::Zstd);
  EXPECT_LT(blob.bytes.size(), 400U);
  EXPECT_EQ(decode(blob)->objects.size(), 30U);
}

TEST(SceneBlob, OfAnotherFormatIsNothing) {
  std::vector<std::uint8_t> bytes = plain(encode_scene({}));
  ASSERT_TRUE(decode_scene(std::ssize(bytes), 1, bytes));
  for (const std::uint8_t format : {std::uint8_t{0}, std::uint8_t{2}}) {
    bytes[0] = format;
    EXPECT_FALSE(decode_scene(std::ssize(bytes), 1, bytes)) << int{format};
  }
}

TEST(SceneBlob, WhatIsNoSceneIsNothing) {
  test::RandomValues values(kSeed);
  RecordedScene scene = values.recorded_scene();
  scene.objects.push_back({"box", BoxShape{{1, 2, 3}}});
  const SceneBlob good = encode_scene(scene);
  SceneBlob blob = good;
  blob.size = 1 << 20;
  EXPECT_FALSE(decode(blob));
  blob.size = (std::int64_t{1} << 20) + 1;
  EXPECT_FALSE(decode(blob));
  EXPECT_FALSE(decode_scene(good.size, 3, good.bytes));
  EXPECT_FALSE(decode_scene(0, 1, {}));
  for (std::size_t i = 0; i < good.bytes.size(); ++i) {  // never a crash, and no scene that is bad
    blob = good;
    blob.bytes[i] ^= static_cast<std::uint8_t>(1 + values.below(255));
    const auto read = decode(blob);
    EXPECT_FALSE(read && check_scene(*read));
    blob = good;
    blob.bytes.resize(i);
    EXPECT_FALSE(decode(blob));
  }
}

}  // namespace
}  // namespace kinship::store::scene_blob_test
