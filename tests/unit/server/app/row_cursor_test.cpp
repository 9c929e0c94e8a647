#include "server/app/row_cursor.hpp"

#include <gtest/gtest.h>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::app::row_cursor_test {
namespace {

AdminReply reply_of(std::vector<std::string> rows) {
  AdminReply reply;
  reply.status = AdminStatus::Ok;
  reply.rows = std::move(rows);
  reply.next_cursor = "next";
  return reply;
}

/// Reads all pages as a client does; counts them.
std::vector<std::string> read_all(const AdminReply& whole, int& pages) {
  std::vector<std::string> rows;
  bool continues = false;
  RowCursor place{.inner = "this"};
  for (pages = 1; pages < 100; ++pages) {
    const AdminReply page = page_of(whole, place);
    EXPECT_EQ(page.status, AdminStatus::Ok) << page.message;
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < page.rows.size(); ++i) {
      bytes += page.rows[i].size();
      EXPECT_TRUE(is_utf8(page.rows[i]));
      if (i == 0 && continues)
        rows.back() += page.rows[i];
      else
        rows.push_back(page.rows[i]);
    }
    EXPECT_LE(bytes, kMaxPageBytes);
    continues = page.last_row_continues;
    if (page.next_cursor == "next")
      return rows;
    EXPECT_LE(page.next_cursor.size(), kMaxCursorBytes);
    place = read_row_cursor(page.next_cursor).value_or_throw();
    EXPECT_EQ(place.inner, "this");
  }
  return rows;
}

TEST(RowCursor, WhatFitsIsOnePage) {
  const AdminReply page = page_of(reply_of({"a", "", "b"}), {});
  EXPECT_EQ(page.rows, (std::vector<std::string>{"a", "", "b"}));
  EXPECT_EQ(page.next_cursor, "next");
  EXPECT_FALSE(page.last_row_continues);
}

TEST(RowCursor, ALongRowComesInPiecesThatMakeItWhole) {
  std::string row;
  for (int i = 0; row.size() < 3 * kMaxPageBytes; ++i)
    row += std::to_string(i) + (i % 3 == 0 ? "\u00e4" : i % 3 == 1 ? "\u20ac" : "\U0001F916");
  const AdminReply whole = reply_of({"short", row, "last"});
  int pages = 0;
  EXPECT_EQ(read_all(whole, pages), whole.rows);
  EXPECT_EQ(pages, 4);
}

TEST(RowCursor, PagesMayEndExactlyBetweenRows) {
  const AdminReply whole = reply_of({std::string(kMaxPageBytes, 'x'), "last"});
  const AdminReply first = page_of(whole, {.inner = "this"});
  EXPECT_FALSE(first.last_row_continues);
  int pages = 0;
  EXPECT_EQ(read_all(whole, pages), whole.rows);
  EXPECT_EQ(pages, 2);
}

TEST(RowCursor, ARowThatChangedMeanwhileIsNotPatchedTogether) {
  AdminReply whole = reply_of({std::string(2 * kMaxPageBytes, 'x')});
  const RowCursor rest =
      read_row_cursor(page_of(whole, {.inner = "this"}).next_cursor).value_or_throw();
  whole.rows[0].back() = 'y';
  const AdminReply page = page_of(whole, rest);
  EXPECT_EQ(page.status, AdminStatus::Failed);
  EXPECT_TRUE(page.rows.empty());
  EXPECT_NE(page.message.find("ask again from the first page"), std::string::npos);
  EXPECT_EQ(page_of(reply_of({}), rest).status, AdminStatus::Failed);
}

TEST(RowCursor, OtherCursorsAreTheServicesOwn) {
  const RowCursor place = read_row_cursor("attempts 1 2 3").value_or_throw();
  EXPECT_EQ(place.inner, "attempts 1 2 3");
  EXPECT_EQ(place.byte, 0U);
  for (const char* bad : {"@", "@1.2", "@1.2.zz.", "@-.1.1.", "@1.2.3"})
    EXPECT_FALSE(read_row_cursor(bad)) << bad;
}

TEST(RowCursor, ATextIsReadBackAsTheSamePlace) {
  const RowCursor place{.inner = "@odd.cursor", .row = 3, .byte = 17, .check = 0xFEDCBA9876543210U};
  const RowCursor read = read_row_cursor(to_text(place)).value_or_throw();
  EXPECT_EQ(read.inner, place.inner);
  EXPECT_EQ(read.row, place.row);
  EXPECT_EQ(read.byte, place.byte);
  EXPECT_EQ(read.check, place.check);
}

}  // namespace
}  // namespace kinship::app::row_cursor_test
