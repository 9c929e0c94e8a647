#include "server/store/sqlite/opening/high_water_mark_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>

#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

std::string checksum_of(const std::string& text) {
  std::array<char, 16> checksum{};
  std::snprintf(checksum.data(), checksum.size(), "%08x",
                crc32c({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  return checksum.data();
}

/// Always as long, so that a shorter one leaves nothing of a longer one behind.
std::string text_of(const HighWaterMarkFile::Mark& mark) {
  std::array<char, 32> position{};
  std::snprintf(position.data(), position.size(), "%020llu",
                static_cast<unsigned long long>(mark.point.position));
  const std::string text =
      mark.epoch.text() + " " + mark.point.run.text() + " " + position.data() + " ";
  return text + checksum_of(text) + "\n";
}

}  // namespace

std::string HighWaterMarkFile::name_of(const std::filesystem::path& store_file) {
  return store_file.string() + ".high-water-mark";
}

HighWaterMarkFile::HighWaterMarkFile(const std::filesystem::path& store_file) {
  try {
    file_.emplace(name_of(store_file), O_RDWR | O_CREAT, 0600);
  } catch (const files::FileError&) {  // no failure: see there
  }
}

std::optional<HighWaterMarkFile::Mark> HighWaterMarkFile::read() const {
  std::string text(256, '\0');
  try {
    text.resize(file_ ? file_->read(text.data(), text.size(), 0) : 0);
  } catch (const files::FileError&) {
    return std::nullopt;
  }
  std::istringstream stream(text);
  std::string epoch, run;
  Mark mark;
  stream >> epoch >> run >> mark.point.position;
  const std::optional<Uuid> parsed_epoch = Uuid::parse(epoch), parsed_run = Uuid::parse(run);
  if (!parsed_epoch || !parsed_run)
    return std::nullopt;
  mark.epoch = *parsed_epoch;
  mark.point.run = *parsed_run;
  if (text_of(mark) != text)
    return std::nullopt;
  return mark;
}

void HighWaterMarkFile::write(const Mark& mark) const {
  try {
    if (file_)
      file_->write(text_of(mark), 0);
  } catch (const files::FileError&) {
  }
}

void HighWaterMarkFile::remove(const std::filesystem::path& store_file) {
  unlink(name_of(store_file).c_str());
}

}  // namespace kinship::store
