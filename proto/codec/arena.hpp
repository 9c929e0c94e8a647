#pragma once

#include <cstddef>
#include <cstring>
#include <memory_resource>
#include <new>
#include <string_view>

namespace kinship::codec {

/// The memory that the strings and sequences of one outgoing message point to; freed at once.
class Arena {
 public:
  /// A copy of `text` with a terminating zero byte.
  char* text(std::string_view text) {
    char* copy = allocate<char>(text.size() + 1);
    if (!text.empty())
      std::memcpy(copy, text.data(), text.size());
    copy[text.size()] = '\0';
    return copy;
  }

  /// Gives a sequence of Cyclone DDS `size` elements, all zero. The arena owns them.
  template <typename Sequence>
  void resize(Sequence& sequence, std::size_t size) {
    using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(size);
    sequence._release = false;
    sequence._buffer = size == 0 ? nullptr : allocate<Element>(size);
  }

  std::size_t bytes() const noexcept { return bytes_; }  ///< handed out so far

 private:
  template <typename Element>
  Element* allocate(std::size_t size) {
    bytes_ += size * sizeof(Element);
    void* memory = resource_.allocate(size * sizeof(Element), alignof(Element));
    std::memset(memory, 0, size * sizeof(Element));
    return static_cast<Element*>(memory);  // C structures: implicit lifetime (C++20)
  }

  std::pmr::monotonic_buffer_resource resource_;
  std::size_t bytes_ = 0;
};

}  // namespace kinship::codec
