#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "proto/json/format.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/uuid.hpp"

/// Reading of untrusted JSON; for the sources of this library only.
namespace kinship::json {

inline constexpr std::size_t kMaxDocumentBytes = 64'000'000;
inline constexpr std::size_t kMaxDocumentValues = 2'000'000;
inline constexpr std::size_t kMaxDocumentDepth = 32;

/// A JSON value and the name of its place in the document, e.g. `record.share`. Borrows from its
/// Document. Every method throws Failure(InvalidInput), or TooLarge, that names place, value and
/// limit if the value does not fit.
class Reader {
 public:
  Reader(const nlohmann::json& value, std::string name) : value_(&value), name_(std::move(name)) {}

  const std::string& name() const noexcept { return name_; }

  Reader at(std::string_view key) const;                       ///< a required member of an object
  std::optional<Reader> find(std::string_view key) const;      ///< empty if missing or null
  std::vector<std::string> keys(std::size_t max_count) const;  ///< of an object

  /// Refuses an object with a member that is not listed, where a misspelt one would be ignored.
  void allow_only(std::initializer_list<std::string_view> members) const;

  std::vector<Reader> elements(std::size_t max_count) const;  ///< of an array

  bool is_null() const;
  bool is_object() const;
  bool boolean() const;
  double number(double lowest = std::numeric_limits<double>::lowest(),
                double highest = std::numeric_limits<double>::max()) const;  ///< always finite
  std::uint64_t count(std::uint64_t highest = std::numeric_limits<std::uint64_t>::max()) const;
  std::int64_t integer() const;
  std::string text(std::size_t max_bytes) const;
  Digest digest() const;
  Uuid uuid() const;
  Eigen::Isometry3d pose() const;                      ///< [x, y, z, qx, qy, qz, qw]
  Eigen::VectorXd vector(std::size_t max_size) const;  ///< a list of numbers

  /// A list of equally long lists of numbers. \return one column per inner list.
  Eigen::MatrixXd columns(std::size_t max_rows, std::size_t max_columns) const;

  [[noreturn]] void refuse(const std::string& problem) const;

 private:
  void require_array(std::size_t max_count) const;
  double number_at(std::size_t index) const;

  const nlohmann::json* value_;
  std::string name_;
};

/// Owner of a parsed document whose size, number of values and depth were checked before.
class Document {
 public:
  /// \param what  named in messages, e.g. "problem".
  /// \throws Failure(TooLarge or InvalidInput).
  Document(std::string_view text, std::string_view what);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document();

  Reader root() const;      ///< \throws Failure(InvalidInput) if it is not an object
  Reader any_root() const;  ///< a value of any type

 private:
  std::unique_ptr<nlohmann::json> json_;
  std::string what_;
};

/// Refuses a document whose member `format` names another kind, or a later version, than `read`.
/// Without the member it is of version 1.
void check_format(const Reader& root, const Format& read);

/// Parses `text` and applies `read` to its root; a Failure becomes the error.
template <typename Read>
Result<std::invoke_result_t<Read, const Reader&>> read_document(std::string_view text,
                                                                std::string_view what, Read read) {
  try {
    const Document document(text, what);
    return read(document.root());
  } catch (const Failure& failure) {
    return failure.error();
  }
}

/// The same for a document of a format, see check_format().
template <typename Read>
Result<std::invoke_result_t<Read, const Reader&>> read_document(std::string_view text,
                                                                std::string_view what,
                                                                const Format& format, Read read) {
  return read_document(text, what, [&](const Reader& root) {
    check_format(root, format);
    return read(root);
  });
}

}  // namespace kinship::json
