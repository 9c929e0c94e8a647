#include "server/http/compression.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

namespace kinship::http::compression_test {
namespace {

bool accepts(const std::string& field) {
  return accepts_gzip({.fields = {{"accept-encoding", field}}});
}

std::string unpacked(const std::string& packed, std::size_t size) {
  std::string text(size + 1, '\0');
  z_stream stream{};
  inflateInit2(&stream, MAX_WBITS + 16);  // gzip alone
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  const int end = inflate(&stream, Z_FINISH);
  EXPECT_EQ(end, Z_STREAM_END);
  text.resize(stream.total_out);
  inflateEnd(&stream);
  return text;
}

TEST(Compression, IsForThoseWhoReadIt) {
  EXPECT_FALSE(accepts_gzip({}));
  for (const char* const yes :
       {"gzip", "gzip, deflate, br", "br;q=1.0, gzip;q=0.5", "deflate ,\tgzip", "*", "br, *;q=0.1"})
    EXPECT_TRUE(accepts(yes)) << yes;
  for (const char* const no : {"", "identity", "gzip;q=0", "gzip; q=0.000", "br, x-gzip2", "*;q=0",
                               "gzip;q=0, *", "gzip;q="})
    EXPECT_FALSE(accepts(no)) << no;
}

TEST(Compression, IsUndoneByZlib) {
  std::string text;
  for (int i = 0; i < 20'000; ++i)
    text += std::to_string(i * i % 1009) + ' ';
  for (const std::string& each : {std::string(), std::string("a"), text})
    for (const Effort effort : {Effort::Fast, Effort::Good})
      EXPECT_EQ(unpacked(gzip(each, effort), each.size()), each);
  EXPECT_LT(gzip(text, Effort::Good).size(), text.size() / 3);
  EXPECT_LE(gzip(text, Effort::Good).size(), gzip(text, Effort::Fast).size());
}

TEST(Compression, IsSaid) {
  const Reply reply = with_gzip(text_reply(200, "text"), "packed");
  EXPECT_EQ(reply.body, "packed");
  const std::vector<std::pair<std::string, std::string>> fields = {{"Content-Encoding", "gzip"},
                                                                   {"Vary", "Accept-Encoding"}};
  EXPECT_EQ(reply.fields, fields);
}

}  // namespace
}  // namespace kinship::http::compression_test
