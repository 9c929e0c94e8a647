#include "server/store/values/compression.hpp"

#include <zstd.h>

#include <memory>
#include <new>

namespace kinship::store {

// Every thread keeps its contexts: half a megabyte each that would go back to the kernel and come
// again with each blob.

std::optional<std::vector<std::uint8_t>> compress(std::span<const std::uint8_t> bytes) {
  constexpr int kLevel = 1;
  struct Free {
    void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
  };
  thread_local const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
  if (!context)
    throw std::bad_alloc();
  std::vector<std::uint8_t> compressed(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compressCCtx(context.get(), compressed.data(), compressed.size(),
                                             bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0 || size >= bytes.size())
    return std::nullopt;
  compressed.resize(size);
  return compressed;
}

std::optional<std::vector<std::uint8_t>> decompress(std::span<const std::uint8_t> bytes,
                                                    std::size_t size) {
  struct Free {
    void operator()(ZSTD_DCtx* context) const noexcept { ZSTD_freeDCtx(context); }
  };
  thread_local const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  if (!context)
    throw std::bad_alloc();
  std::vector<std::uint8_t> plain(size);
  if (ZSTD_decompressDCtx(context.get(), plain.data(), plain.size(), bytes.data(), bytes.size()) !=
      size)
    return std::nullopt;  // also every error code of zstd
  return plain;
}

}  // namespace kinship::store
