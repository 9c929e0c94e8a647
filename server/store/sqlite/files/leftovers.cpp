#include "server/store/sqlite/files/leftovers.hpp"

#include <cstring>
#include <system_error>
#include <vector>

#include "proto/files/file.hpp"
#include "proto/types/time_text.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

std::uintmax_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

std::string listed(const std::vector<fs::path>& paths) {
  std::string text;
  for (const fs::path& path : paths)
    text += (text.empty() ? "'" : ", '") + path.string() + "'";
  return text;
}

}  // namespace

void require_no_leftovers(const fs::path& located) {
  std::vector<fs::path> found;
  for (const char* const suffix : {"-wal", ".high-water-mark"})
    if (const fs::path path = located.string() + suffix; size_of(path) > 0)
      found.push_back(path);
  // A file that is being made is empty beside lock and journal, and has pages before a WAL has.
  const bool is_missing = !fs::exists(located);
  for (const char* const suffix : {"-journal", ".lock"})
    if (const fs::path path = located.string() + suffix; is_missing && fs::exists(path))
      found.push_back(path);
  if (found.empty() || size_of(located) > 0)
    return;
  refuse_store(located, std::string(is_missing ? "the file is missing" : "the file is empty") +
                            ", but " + listed(found) +
                            (found.size() == 1 ? " is there" : " are there") +
                            ": put the store back (mount its disk, or 'kinshipd restore'), or "
                            "begin a new one with --new-store");
}

void set_leftovers_aside(const fs::path& located) {
  if (size_of(located) > 0)
    refuse_store(located, "is there; --new-store is for a store that is to be made");
  move_sidecars(located, located.string() + ".replaced-" + time_stamp());
  std::error_code none;
  fs::remove(located.string() + ".high-water-mark", none);
}

void move_sidecars(const fs::path& located, const fs::path& replaced) {
  for (const std::string sidecar : kSidecars) {
    const fs::path from = located.string() + sidecar;
    if (!fs::exists(from))
      continue;
    if (const int error = files::rename_new(from, replaced.string() + "." + sidecar.substr(1)))
      refuse_store(from, std::string("cannot be set aside: ") + std::strerror(error));
  }
}

std::string time_stamp() {
  std::string text = time_text(now_ms());
  std::erase_if(text, [](char c) { return c == '-' || c == ':'; });
  return text;
}

}  // namespace kinship::store
