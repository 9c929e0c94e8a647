#include "server/service/job_rows.hpp"

#include "proto/types/failure.hpp"

namespace kinship::service {

void JobRows::add(std::string_view row) {
  const std::size_t needed = text_.size() + row.size() + (ends_.size() + 1) * sizeof(std::size_t);
  if (needed > max_bytes_)
    throw Failure(ErrorCode::TooLarge, "row " + std::to_string(ends_.size() + 1) + " needs " +
                                           std::to_string(needed) +
                                           " bytes together with those before it, a job may keep " +
                                           std::to_string(max_bytes_));
  text_ += row;
  ends_.push_back(text_.size());
}

std::size_t JobRows::bytes() const noexcept {
  return text_.capacity() + ends_.capacity() * sizeof(std::size_t);
}

std::vector<std::string> JobRows::page(std::size_t first, std::size_t limit,
                                       std::size_t max_bytes) const {
  std::vector<std::string> rows;
  std::size_t bytes = 0;
  for (std::size_t i = first; i < size() && rows.size() < limit; ++i) {
    bytes += row(i).size();
    if (!rows.empty() && bytes > max_bytes)
      break;
    rows.emplace_back(row(i));
  }
  return rows;
}

std::string_view JobRows::row(std::size_t index) const {
  const std::size_t begin = index == 0 ? 0 : ends_[index - 1];
  return std::string_view(text_).substr(begin, ends_[index] - begin);
}

}  // namespace kinship::service
