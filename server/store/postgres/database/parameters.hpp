#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/session.hpp"

namespace kinship::store::postgres {

/// The parameters of a statement, in libpq's binary format: $1, $2, ... in the order in which they
/// are added. Their types are those of the C++ values: bigint, double precision, boolean, text,
/// bytea, and arrays of these (for unnest and = ANY). Copies its values.
class Parameters {
 public:
  Parameters() = default;
  template <typename... Values>
  explicit Parameters(const Values&... values) {
    (add(values), ...);
  }

  Parameters& add(std::int64_t value);
  Parameters& add(double value);
  Parameters& add(bool value);
  Parameters& add(std::string_view value);
  Parameters& add(Bytes value);
  Parameters& add(const std::string& value) { return add(std::string_view(value)); }
  Parameters& add(const char* value) { return add(std::string_view(value)); }
  Parameters& add(const std::vector<std::uint8_t>& value) { return add(Bytes(value)); }

  /// A value, or NULL of its type.
  template <typename Value>
  Parameters& add(const std::optional<Value>& value) {
    if (value)
      return add(*value);
    add(Value{});
    return make_null();
  }

  Parameters& add(const Parameter& value);

  Parameters& add(const std::vector<std::int64_t>& values);
  Parameters& add(const std::vector<double>& values);
  Parameters& add(const std::vector<std::string>& values);
  Parameters& add(const std::vector<Bytes>& values);
  Parameters& add(const std::vector<std::optional<std::int64_t>>& values);
  Parameters& add(const std::vector<std::optional<Bytes>>& values);

  std::size_t size() const noexcept { return types_.size(); }
  const std::vector<unsigned>& types() const noexcept { return types_; }  ///< PostgreSQL's OIDs

  /// The bytes of parameter `index`; null: NULL.
  const char* value(std::size_t index) const noexcept;
  int length(std::size_t index) const noexcept;

 private:
  template <typename Integer>
  void put(Integer value);  // big-endian
  void put(Bytes bytes);
  void begin(unsigned type);
  void end();
  Parameters& make_null();
  /// \param put_element  writes the size and the bytes of an element.
  template <typename Values, typename PutElement>
  Parameters& add_array(unsigned type, unsigned element, const Values& values,
                        PutElement put_element);

  struct Place {
    std::size_t begin = 0;
    std::size_t size = 0;
    bool is_null = false;
  };
  std::vector<char> buffer_;
  std::vector<Place> places_;
  std::vector<unsigned> types_;
};

}  // namespace kinship::store::postgres
