#pragma once

#include <stdexcept>
#include <utility>
#include <variant>

#include "proto/types/failure.hpp"

namespace kinship {

/// A value, or the reason why there is none. For outcomes that callers branch on.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  explicit operator bool() const noexcept { return content_.index() == 0; }
  bool has_value() const noexcept { return content_.index() == 0; }

  /// \throws std::logic_error if there is no value.
  const T& value() const& {
    require(0);
    return *std::get_if<0>(&content_);
  }
  T&& value() && {
    require(0);
    return std::move(*std::get_if<0>(&content_));
  }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }

  /// \throws std::logic_error if there is a value.
  const Error& error() const {
    require(1);
    return *std::get_if<1>(&content_);
  }

  /// The value, or its reason as the exception that ends a request.
  /// \throws Failure with the error.
  T value_or_throw() && {
    if (!has_value())
      throw Failure(error());
    return std::move(*this).value();
  }

 private:
  void require(std::size_t index) const {
    if (content_.index() != index)
      throw std::logic_error(index == 0 ? "Result: no value" : "Result: no error");
  }

  std::variant<T, Error> content_;
};

}  // namespace kinship
