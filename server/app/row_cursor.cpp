#include "server/app/row_cursor.hpp"

#include <cinttypes>
#include <cstdio>
#include <utility>

#include "proto/types/limits.hpp"

namespace kinship::app {
namespace {

/// No cursor of the service begins like this.
constexpr char kMark = '@';

/// The largest length up to `most` at which the text can be cut between two characters of UTF-8.
std::size_t cut_length(const std::string& text, std::size_t most) {
  if (most >= text.size())
    return text.size();
  const auto is_inside = [&text](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  std::size_t length = most;
  while (length > 0 && is_inside(length))
    --length;
  return length;
}

AdminReply changed_meanwhile() {
  AdminReply failed;
  failed.status = AdminStatus::Failed;
  failed.message = "the row changed while it was read page by page: ask again from the first page";
  return failed;
}

}  // namespace

std::uint64_t fingerprint(const std::string& row) {
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a, 64 bits
  for (const char c : row)
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

std::string to_text(const RowCursor& cursor) {
  char place[64];
  std::snprintf(place, sizeof place, "%c%zu.%zu.%016" PRIx64 ".", kMark, cursor.row, cursor.byte,
                cursor.check);
  return place + cursor.inner;
}

Result<RowCursor> read_row_cursor(const std::string& cursor) {
  if (cursor.empty() || cursor.front() != kMark)
    return RowCursor{cursor, 0, 0, 0};
  RowCursor place;
  int length = 0;
  const int read = std::sscanf(cursor.c_str(), "@%6zu.%9zu.%16" SCNx64 ".%n", &place.row,
                               &place.byte, &place.check, &length);
  if (read != 3 || length == 0)
    return Error{ErrorCode::InvalidInput, "'" + cursor + "' is no cursor of this server"};
  place.inner = cursor.substr(static_cast<std::size_t>(length));
  return place;
}

AdminReply page_of(AdminReply reply, const RowCursor& begin) {
  if (reply.status != AdminStatus::Ok)
    return reply;
  const bool is_start = begin.row == 0 && begin.byte == 0;
  if (!is_start && (begin.row >= reply.rows.size() || begin.byte > reply.rows[begin.row].size() ||
                    fingerprint(reply.rows[begin.row]) != begin.check))
    return changed_meanwhile();

  AdminReply page;
  page.status = reply.status;
  page.message = std::move(reply.message);
  std::size_t room = kMaxPageBytes;
  RowCursor place = begin;
  for (; place.row < reply.rows.size(); ++place.row, place.byte = 0) {
    const std::string rest = reply.rows[place.row].substr(place.byte);
    const std::size_t length = cut_length(rest, room);
    if (length == 0 && !rest.empty())
      break;
    page.rows.push_back(rest.substr(0, length));
    room -= length;
    place.byte += length;
    page.last_row_continues = length < rest.size();
    if (page.last_row_continues)
      break;
  }
  if (place.row == reply.rows.size()) {
    page.next_cursor = std::move(reply.next_cursor);
    return page;
  }
  place.check = fingerprint(reply.rows[place.row]);
  page.next_cursor = to_text(place);
  return page;
}

}  // namespace kinship::app
