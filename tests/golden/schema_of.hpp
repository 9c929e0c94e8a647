#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/field.hpp"
#include "proto/types/uuid.hpp"

/// JSON Schemas (draft 2020-12) of values, by the tables of fields that writers and readers use.
namespace kinship::test {

using Schema = nlohmann::ordered_json;

inline Schema schema_of_type(std::string_view type) { return {{"type", type}}; }
inline Schema number() { return schema_of_type("number"); }
inline Schema boolean() { return schema_of_type("boolean"); }
inline Schema integer() { return schema_of_type("integer"); }
inline Schema count() { return {{"type", "integer"}, {"minimum", 0}}; }

/// \param limit  of its bytes, so of its characters, too; 0: none is known.
inline Schema text(std::size_t limit = 0) {
  Schema schema = schema_of_type("string");
  if (limit > 0)
    schema["maxLength"] = limit;
  return schema;
}
inline Schema matching(std::string_view pattern) {
  return {{"type", "string"}, {"pattern", pattern}};
}
inline Schema digest() { return matching("^[0-9a-f]{64}$"); }
inline Schema uuid() { return matching("^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$"); }

inline Schema list_of(Schema items, std::size_t limit = 0) {
  Schema schema = {{"type", "array"}, {"items", std::move(items)}};
  if (limit > 0)
    schema["maxItems"] = limit;
  return schema;
}
inline Schema exactly(std::size_t size, Schema items) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", size}, {"maxItems", size}};
}
inline Schema pose() { return exactly(7, number()); }
inline Schema configuration() { return list_of(number()); }
inline Schema or_null(Schema schema) {
  return {{"anyOf", {std::move(schema), schema_of_type("null")}}};
}
inline Schema words(const auto& list) {
  Schema schema;
  schema["enum"] = Schema::array();
  for (const std::string_view word : list)
    schema["enum"].push_back(word);
  return schema;
}

/// A member of an object.
struct Member {
  std::string name;
  Schema schema;
  bool may_be_missing = false;
};
using Members = std::vector<Member>;

template <typename T>
Schema schema_of(const FieldRules& rules = {});

/// The members that a table describes. A reader asks for those that may not be missing.
template <typename Table>
Members members_of(const Table& table) {
  Members members;
  for_each_field(table, [&members]<typename Of, typename T>(const Field<Of, T>& field) {
    members.push_back({std::string(field.name), schema_of<T>(field.rules),
                       field.rules.may_be_missing || kIsOptional<T>});
  });
  return members;
}

/// The members of each, one after another.
inline Members joined(std::initializer_list<Members> parts) {
  Members all;
  for (const Members& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// An object of these members and no others.
inline Schema object_of(const Members& members) {
  Schema schema = schema_of_type("object");
  schema["properties"] = Schema::object();
  schema["required"] = Schema::array();
  for (const Member& member : members) {
    schema["properties"][member.name] = member.schema;
    if (!member.may_be_missing)
      schema["required"].push_back(member.name);
  }
  schema["additionalProperties"] = false;
  return schema;
}

template <typename T>
Schema schema_of(const FieldRules& rules) {
  if constexpr (kIsOptional<T>) {
    return or_null(schema_of<typename T::value_type>(rules));
  } else if constexpr (kIsList<T>) {
    return list_of(schema_of<typename T::value_type>({.limit = rules.element_limit}), rules.limit);
  } else if constexpr (Described<T>) {
    return object_of(members_of(kFieldsOf<T>));
  } else if constexpr (std::is_enum_v<T>) {
    return words(Words<T>::kWords);
  } else if constexpr (std::is_same_v<T, Digest>) {
    return digest();
  } else if constexpr (std::is_same_v<T, Uuid>) {
    return uuid();
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    return pose();
  } else if constexpr (std::is_same_v<T, std::string>) {
    return text(rules.limit);
  } else if constexpr (std::is_same_v<T, bool>) {
    return boolean();
  } else if constexpr (std::is_unsigned_v<T>) {
    return count();
  } else {
    Schema schema = std::is_floating_point_v<T> ? number() : integer();
    if (rules.min > std::numeric_limits<double>::lowest())
      schema["minimum"] = rules.min;
    if (rules.max < std::numeric_limits<double>::max())
      schema["maximum"] = rules.max;
    return schema;
  }
}

/// A document's schema, and the name of its file.
struct DocumentSchema {
  std::string file;  ///< e.g. "problem-1.schema.json"
  Schema schema;
};

/// Of every document that the programs in C++ write or read.
std::vector<DocumentSchema> document_schemas();

}  // namespace kinship::test
