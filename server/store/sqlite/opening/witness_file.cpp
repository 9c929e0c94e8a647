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
  constexpr mode_t kOwnerOnly = 0600;
  descriptor_ = open(witness_name(store_file).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerOnly);
}

WitnessFile::~WitnessFile() {
  if (descriptor_ >= 0)
    close(descriptor_);
}

std::optional<WitnessFile::Testimony> WitnessFile::read() const {
  std::array<char, 256> bytes{};
  const ssize_t size = descriptor_ < 0 ? -1 : pread(descriptor_, bytes.data(), bytes.size(), 0);
  if (size <= 0)
    return std::nullopt;
  const std::string text(bytes.data(), static_cast<std::size_t>(size));
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
  if (descriptor_ < 0)
    return;
  const std::string text = text_of(testimony);
  static_cast<void>(pwrite(descriptor_, text.data(), text.size(), 0) == 0);
}

void WitnessFile::remove(const std::filesystem::path& store_file) {
  unlink(witness_name(store_file).c_str());
}

}  // namespace kinship::store
