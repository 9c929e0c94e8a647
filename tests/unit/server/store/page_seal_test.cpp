#include "server/store/sqlite/database/page_seal.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace kinship::store::page_seal_test {
namespace {

std::vector<std::uint8_t> random_page(std::size_t size) {
  std::mt19937 generator(7);
  std::vector<std::uint8_t> page(size);
  for (std::uint8_t& byte : page)
    byte = static_cast<std::uint8_t>(generator());
  return page;
}

TEST(PageSeal, FindsEveryFlippedBitTheSealsToo) {
  std::vector<std::uint8_t> page = random_page(512);
  seal_page(page, 3);
  ASSERT_TRUE(is_sealed(page, 3));
  for (std::size_t bit = 0; bit < 8 * page.size(); ++bit) {
    page[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(is_sealed(page, 3)) << bit;
    page[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
}

TEST(PageSeal, IsOfOnePlaceAlone) {
  std::vector<std::uint8_t> page = random_page(8192);
  seal_page(page, 3);
  EXPECT_FALSE(is_sealed(page, 4));
}

TEST(PageSeal, ASpoiledOneStaysWrong) {
  std::vector<std::uint8_t> page = random_page(1024);
  seal_page(page, 1);
  spoil_seal(page);
  EXPECT_TRUE(bears_seal(page));
  EXPECT_FALSE(is_sealed(page, 1));
}

TEST(PageSeal, TellsAPageFromAPart) {
  EXPECT_TRUE(is_page(8192, 0) && is_page(8192, 16384) && is_page(512, 512));
  EXPECT_FALSE(is_page(100, 0) || is_page(16, 24) || is_page(8192, 4096) || is_page(8216, 0));
  EXPECT_TRUE(is_hole(std::vector<std::uint8_t>(512)));
  EXPECT_FALSE(is_hole(random_page(512)));
}

}  // namespace
}  // namespace kinship::store::page_seal_test
