#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"

namespace kinship::store {

/// Sets aside what a reader found damaged; if it fails, the next reader finds it again.
class DamageItem : public WriteItem {
 public:
  DamageItem(AsideKind kind, std::vector<std::int64_t> rows)
      : kind_(kind), rows_(std::move(rows)) {}

  void apply(Batch& batch) override {
    if (kind_ == AsideKind::Path)
      set_aside(batch, rows_);
    else
      for (const std::int64_t row : rows_)
        put_aside(batch.database(), kind_, row);
  }
  void finish(const Error* /*error*/) override {}

 private:
  AsideKind kind_;
  std::vector<std::int64_t> rows_;
};

}  // namespace kinship::store
