#include "server/store/postgres/database/parameters.hpp"

#include <bit>
#include <limits>
#include <stdexcept>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {
namespace {

// pg_type.dat: these numbers are the same in every PostgreSQL.
constexpr unsigned kBool = 16, kBytea = 17, kInt8 = 20, kText = 25, kFloat8 = 701;
constexpr unsigned kByteaArray = 1001, kTextArray = 1009, kInt8Array = 1016, kFloat8Array = 1022;
constexpr std::int32_t kNullElement = -1;

Bytes bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::int32_t size_of(Bytes bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw Failure(ErrorCode::TooLarge,
                  "a value of " + std::to_string(bytes.size()) + " bytes, PostgreSQL takes 1 GB");
  return static_cast<std::int32_t>(bytes.size());
}

}  // namespace

template <typename Integer>
void Parameters::put(Integer value) {
  for (int shift = 8 * static_cast<int>(sizeof(Integer)) - 8; shift >= 0; shift -= 8)
    buffer_.push_back(
        static_cast<char>(static_cast<std::uint64_t>(value) >> static_cast<unsigned>(shift)));
}

void Parameters::put(Bytes bytes) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());
  buffer_.insert(buffer_.end(), begin, begin + bytes.size());
}

void Parameters::begin(unsigned type) {
  types_.push_back(type);
  places_.push_back({.begin = buffer_.size()});
}

void Parameters::end() {
  places_.back().size = buffer_.size() - places_.back().begin;
  if (places_.back().size == 0)
    buffer_.push_back('\0');  // an address of its own: a null one would mean NULL
}

Parameters& Parameters::make_null() {
  places_.back().is_null = true;
  return *this;
}

Parameters& Parameters::add(std::int64_t value) {
  begin(kInt8);
  put(value);
  end();
  return *this;
}

Parameters& Parameters::add(double value) {
  begin(kFloat8);
  put(std::bit_cast<std::uint64_t>(value));
  end();
  return *this;
}

Parameters& Parameters::add(bool value) {
  begin(kBool);
  buffer_.push_back(value ? '\1' : '\0');
  end();
  return *this;
}

Parameters& Parameters::add(std::string_view value) {
  begin(kText);
  put(bytes_of(value));
  end();
  return *this;
}

Parameters& Parameters::add(Bytes value) {
  static_cast<void>(size_of(value));
  begin(kBytea);
  put(value);
  end();
  return *this;
}

Parameters& Parameters::add(const Parameter& value) {
  std::visit([this](const auto& each) { add(each); }, value.value());
  return value.is_null() ? make_null() : *this;
}

template <typename Values, typename PutElement>
Parameters& Parameters::add_array(unsigned type, unsigned element, const Values& values,
                                  PutElement put_element) {
  begin(type);
  put(std::int32_t{values.empty() ? 0 : 1});  // dimensions
  put(std::int32_t{1});                       // there may be NULLs
  put(static_cast<std::int32_t>(element));
  if (!values.empty()) {
    put(static_cast<std::int32_t>(values.size()));
    put(std::int32_t{1});  // the first index
    for (const auto& value : values)
      put_element(value);
  }
  end();
  return *this;
}

Parameters& Parameters::add(const std::vector<std::int64_t>& values) {
  return add_array(kInt8Array, kInt8, values, [this](std::int64_t value) {
    put(std::int32_t{8});
    put(value);
  });
}

Parameters& Parameters::add(const std::vector<double>& values) {
  return add_array(kFloat8Array, kFloat8, values, [this](double value) {
    put(std::int32_t{8});
    put(std::bit_cast<std::uint64_t>(value));
  });
}

Parameters& Parameters::add(const std::vector<std::string>& values) {
  return add_array(kTextArray, kText, values, [this](const std::string& value) {
    put(size_of(bytes_of(value)));
    put(bytes_of(value));
  });
}

Parameters& Parameters::add(const std::vector<Bytes>& values) {
  return add_array(kByteaArray, kBytea, values, [this](Bytes value) {
    put(size_of(value));
    put(value);
  });
}

Parameters& Parameters::add(const std::vector<std::optional<std::int64_t>>& values) {
  return add_array(kInt8Array, kInt8, values, [this](const std::optional<std::int64_t>& value) {
    put(value ? std::int32_t{8} : kNullElement);
    if (value)
      put(*value);
  });
}

Parameters& Parameters::add(const std::vector<std::optional<Bytes>>& values) {
  return add_array(kByteaArray, kBytea, values, [this](const std::optional<Bytes>& value) {
    put(value ? size_of(*value) : kNullElement);
    if (value)
      put(*value);
  });
}

const char* Parameters::value(std::size_t index) const noexcept {
  const Place& place = places_[index];
  return place.is_null ? nullptr : buffer_.data() + place.begin;
}

int Parameters::length(std::size_t index) const noexcept {
  return static_cast<int>(places_[index].size);
}

}  // namespace kinship::store::postgres
