#include "server/http/compression.hpp"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <new>
#include <utility>

namespace kinship::http {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  return text.substr(0, text.find_last_not_of(kSpace) + 1);
}

/// Whether "gzip;q=0.5" is more than none: it is without a quality.
bool is_wanted(std::string_view coding) {
  const std::size_t at = coding.find("q=");
  if (at == std::string_view::npos)
    return true;
  const std::string_view number = coding.substr(at + 2);
  double quality = 0;
  std::from_chars(number.data(), number.data() + number.size(), quality);
  return quality > 0;
}

}  // namespace

bool accepts_gzip(const Request& request) {
  const std::string* const field = request.field("accept-encoding");
  std::string_view rest = field == nullptr ? std::string_view() : *field;
  bool is_accepted = false;
  while (!rest.empty()) {
    const std::string_view coding = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(coding.size() + 1, rest.size()));
    const std::string_view name = trimmed(coding.substr(0, coding.find(';')));
    if (name == "gzip")
      return is_wanted(coding);
    is_accepted = is_accepted || (name == "*" && is_wanted(coding));
  }
  return is_accepted;
}

std::string gzip(std::string_view text, Effort effort) {
  constexpr int kGzip = 16;  // added to the window's bits: gzip, not zlib
  constexpr int kMemory = 8;
  z_stream stream{};
  if (deflateInit2(&stream, effort == Effort::Fast ? Z_BEST_SPEED : Z_DEFAULT_COMPRESSION,
                   Z_DEFLATED, MAX_WBITS + kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int end = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (end != Z_STREAM_END)
    throw std::bad_alloc();
  return packed;
}

Reply with_gzip(Reply reply, std::string gzipped) {
  reply.body = std::move(gzipped);
  reply.fields.emplace_back("Content-Encoding", "gzip");
  reply.fields.emplace_back("Vary", "Accept-Encoding");
  return reply;
}

}  // namespace kinship::http
