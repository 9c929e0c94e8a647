#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kinship::service {

/// The lines that a job makes, in one piece of memory with a limit. Not shared between threads
/// while it grows.
class JobRows {
 public:
  /// \param max_bytes  of all rows together.
  explicit JobRows(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// \throws Failure(TooLarge) with the limit if there is no room for it.
  void add(std::string_view row);

  std::size_t size() const noexcept { return ends_.size(); }  ///< number of rows
  std::size_t bytes() const noexcept;                         ///< of memory

  /// Rows from `first` on: at most `limit`, and at most `max_bytes` together, but at least the
  /// first one, however long it is.
  std::vector<std::string> page(std::size_t first, std::size_t limit, std::size_t max_bytes) const;

 private:
  std::string_view row(std::size_t index) const;

  const std::size_t max_bytes_;
  std::string text_;               // the rows, concatenated
  std::vector<std::size_t> ends_;  // of each row in text_
};

}  // namespace kinship::service
