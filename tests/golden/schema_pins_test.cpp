// The schemas of documents are those of the tables of fields.

#include <gtest/gtest.h>

#include "tests/golden/pins.hpp"
#include "tests/golden/schema_of.hpp"

namespace kinship::test {
namespace {

TEST(SchemaPins, SchemasAreThoseOfTheTables) {
  constexpr int kIndent = 1;
  for (const DocumentSchema& each : document_schemas())
    expect_pinned("../../../proto/json/schemas/" + each.file, each.schema.dump(kIndent) + "\n");
}

}  // namespace
}  // namespace kinship::test
