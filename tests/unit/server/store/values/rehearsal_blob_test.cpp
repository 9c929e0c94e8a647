#include "server/store/values/rehearsal_blob.hpp"

#include <gtest/gtest.h>

#include "tests/support/store_values.hpp"

namespace kinship::store::rehearsal_blob_test {
namespace {

bool is_readable(std::span<const std::uint8_t> blob) {
  StoredRehearsal read;
  return decode_rehearsal(blob, read);
}

TEST(RehearsalBlob, NoPartOfItIsOne) {
  std::vector<std::uint8_t> blob =
      encode_rehearsal(test::make_rehearsal(test::id_from<Digest>(1), "shelf", 2));
  EXPECT_TRUE(is_readable(blob));
  for (std::size_t size = 0; size < blob.size(); ++size)
    EXPECT_FALSE(is_readable(std::span(blob).first(size))) << size;
  blob.push_back(0);
  EXPECT_FALSE(is_readable(blob));
}

TEST(RehearsalBlob, OneOfAnotherFormatIsRefused) {
  std::vector<std::uint8_t> blob =
      encode_rehearsal(test::make_rehearsal(test::id_from<Digest>(1), "shelf", 2));
  ++blob[0];
  EXPECT_FALSE(is_readable(blob));
}

TEST(RehearsalBlob, ALibraryThatBreaksARuleIsRefused) {
  StoredRehearsal bad = test::make_rehearsal(test::id_from<Digest>(1), "shelf", 2);
  bad.library->paths[0].query = 2;  // of two
  EXPECT_FALSE(is_readable(encode_rehearsal(bad)));
}

}  // namespace
}  // namespace kinship::store::rehearsal_blob_test
