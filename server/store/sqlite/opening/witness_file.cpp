#include "server/store/sqlite/opening/witness_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>

#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

std::string witness_name(const std::filesystem::path& store_file) {
  return store_file.string() + ".witness";
}

std::string seal_of(const std::string& text) {
  std::array<char, 16> seal{};
  std::snprintf(seal.data(), seal.size(), "%08x",
                crc32c({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  return seal.data();
}

/// Always as long, so that a shorter one leaves nothing of a longer one behind.
std::string text_of(const WitnessFile::Testimony& testimony) {
  std::array<char, 32> position{};
  std::snprintf(position.data(), position.size(), "%020llu",
                static_cast<unsigned long long>(testimony.point.position));
  const std::string text =
      testimony.epoch.text() + " " + testimony.point.run.text() + " " + position.data() + " ";
  return text + seal_of(text) + "\n";
}

}  // namespace

WitnessFile::WitnessFile(const std::filesystem::path& store_file) {
  try {
    file_.emplace(witness_name(store_file), O_RDWR | O_CREAT, 0600);
  } catch (const files::FileError&) {  // no failure: see there
  }
}

std::optional<WitnessFile::Testimony> WitnessFile::read() const {
  std::string text(256, '\0');
  try {
    text.resize(file_ ? file_->read(text.data(), text.size(), 0) : 0);
  } catch (const files::FileError&) {
    return std::nullopt;
  }
  std::istringstream stream(text);
  std::string epoch, run;
  Testimony testimony;
  stream >> epoch >> run >> testimony.point.position;
  const std::optional<Uuid> parsed_epoch = Uuid::parse(epoch), parsed_run = Uuid::parse(run);
  if (!parsed_epoch || !parsed_run)
    return std::nullopt;
  testimony.epoch = *parsed_epoch;
  testimony.point.run = *parsed_run;
  if (text_of(testimony) != text)
    return std::nullopt;
  return testimony;
}

void WitnessFile::write(const Testimony& testimony) const {
  try {
    if (file_)
      file_->write(text_of(testimony), 0);
  } catch (const files::FileError&) {
  }
}

void WitnessFile::remove(const std::filesystem::path& store_file) {
  unlink(witness_name(store_file).c_str());
}

}  // namespace kinship::store
