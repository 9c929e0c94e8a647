// What the store keeps as bytes: today's format as it is written, every format as it is read.

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <span>

#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "server/store/values/compression.hpp"
#include "server/store/values/distribution_blob.hpp"
#include "server/store/values/rehearsal_blob.hpp"
#include "server/store/values/scene_blob.hpp"
#include "server/store/values/search_blob.hpp"
#include "server/store/values/waypoint_blob.hpp"
#include "tests/golden/every_value.hpp"
#include "tests/golden/pins.hpp"

namespace kinship::store::blob_pins_test {
namespace {

constexpr int kFormat = 1;  // of today

std::string blob_name(int format) { return "blob/distribution-" + std::to_string(format) + ".hex"; }

TEST(BlobPins, DistributionsAreWrittenAsPinned) {
  test::expect_pinned_bytes(blob_name(kFormat), encode_distribution(test::every_distribution()));
  test::expect_pinned_bytes("blob/distribution-kernels.hex",
                            encode_distribution(test::every_kernels()));
  test::expect_pinned_bytes("blob/distribution-failed.hex",
                            encode_distribution(test::every_failure()));
}

TEST(BlobPins, DistributionsOfEveryFormatAreRead) {
  for (int format = 1; format <= kFormat; ++format) {
    const auto distribution = decode_distribution(test::read_pinned_bytes(blob_name(format)));
    ASSERT_TRUE(distribution) << format;
    test::expect_pinned("blob/distribution-" + std::to_string(format) + ".json",
                        json::to_json(*distribution) + "\n");
  }
}

StoredRehearsal every_stored_rehearsal() {
  test::Distinct next(6000);
  StoredRehearsal rehearsal;
  rehearsal.kind = next.id<Digest>();
  rehearsal.paths = next.count();
  rehearsal.retired = next.count();
  rehearsal.T_task_base = next.pose();
  rehearsal.rehearsal = test::every_rehearsal();
  rehearsal.library = test::every_fetch_reply().recall;
  return rehearsal;
}

TEST(BlobPins, RehearsalsAreWrittenAsPinnedAndRead) {
  const std::string name = "blob/rehearsal-" + std::to_string(kRehearsalVersion) + ".hex";
  const std::vector<std::uint8_t> blob = encode_rehearsal(every_stored_rehearsal());
  test::expect_pinned_bytes(name, blob);
  StoredRehearsal read;
  ASSERT_TRUE(decode_rehearsal(test::read_pinned_bytes(name), read));
  EXPECT_EQ(encode_rehearsal(read), blob);
}

/// zstd may compress otherwise tomorrow: what is compressed is pinned, and that it comes back.
std::optional<RecordedScene> check_scene_pin(const std::string& name, const RecordedScene& scene) {
  const SceneBlob blob = encode_scene(scene);
  EXPECT_EQ(blob.encoding, SceneEncoding::Zstd);
  const auto plain = decompress(blob.bytes, static_cast<std::size_t>(blob.size));
  test::expect_pinned_bytes(name, plain.value());
  return decode_scene(blob.size, 2, blob.bytes);
}

TEST(BlobPins, ScenesAreWrittenAsPinned) {
  RecordedScene unconstrained = test::every_recorded_scene();
  unconstrained.constraint.reset();
  EXPECT_TRUE(check_scene_pin("blob/scene.hex", unconstrained));
  const auto scene = check_scene_pin("blob/scene-constrained.hex", test::every_recorded_scene());
  ASSERT_TRUE(scene);
  RecordedScene approximate = test::every_recorded_scene();
  approximate.objects[1].approximate = approximate.held[0].approximate = true;
  const auto read = check_scene_pin("blob/scene-approximate.hex", approximate);
  ASSERT_TRUE(read);
  EXPECT_EQ(content_digest(*read), content_digest(approximate));
  EXPECT_NE(content_digest(*read), content_digest(*scene));
  Attempt attempt = test::every_attempt();
  attempt.scene = scene;
  const std::string pin = test::read_pin("json/attempt.txt");  // its first line is the document
  EXPECT_EQ(json::to_json(attempt), pin.substr(0, pin.find('\n')));
}

/// What is compressed is pinned, after its size, as a record is that compresses badly.
TEST(BlobPins, SearchRecordsAreWrittenAsPinnedAndRead) {
  const std::vector<std::uint8_t> blob = encode_search(test::every_search_record());
  std::uint64_t size = 0;
  ASSERT_GT(blob.size(), sizeof size);
  std::memcpy(&size, blob.data(), sizeof size);
  std::vector<std::uint8_t> plain(blob.begin(), blob.begin() + sizeof size);
  const std::span<const std::uint8_t> rest(blob.begin() + sizeof size, blob.end());
  const std::vector<std::uint8_t> content =
      rest.size() == size ? std::vector(rest.begin(), rest.end()) : decompress(rest, size).value();
  plain.insert(plain.end(), content.begin(), content.end());
  test::expect_pinned_bytes("blob/search.hex", plain);
  const auto read = decode_search(test::read_pinned_bytes("blob/search.hex"));
  ASSERT_TRUE(read);
  EXPECT_EQ(encode_search(*read), blob);
}

TEST(BlobPins, WaypointsAreWrittenAsPinned) {
  std::mt19937_64 generator(4000);
  const Eigen::MatrixXd waypoints = Eigen::MatrixXd::NullaryExpr(
      4, 5, [&] { return static_cast<double>(generator() >> 11U) / 9007199254740992.0; });
  const WaypointBlob raw = encode_waypoints(waypoints);
  ASSERT_EQ(raw.encoding, WaypointEncoding::Raw);
  test::expect_pinned_bytes("blob/waypoints-raw.hex", raw.bytes);
  const Eigen::MatrixXd line = test::Distinct(5000).matrix(4, 100);
  const WaypointBlob delta = encode_waypoints(line);
  ASSERT_EQ(delta.encoding, WaypointEncoding::Delta);
  const auto planes = decompress(delta.bytes, static_cast<std::size_t>(line.size()) * 8);
  ASSERT_TRUE(planes);
  test::expect_pinned_bytes("blob/waypoints-delta.hex", *planes);
  const auto path = decode_waypoints(4, 100, 2, delta.bytes);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->waypoints(), line);
}

}  // namespace
}  // namespace kinship::store::blob_pins_test
