#include "proto/json/reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxShownBytes = 40;

/// The beginning of a text from outside, without control characters.
std::string shown(std::string_view text) {
  std::string beginning = cut_text(text, kMaxShownBytes);
  const auto is_control = [](unsigned char byte) { return byte < 0x20 || byte == 0x7f; };
  std::ranges::replace_if(beginning, is_control, '?');
  return beginning;
}

[[noreturn]] void throw_too_large(const std::string& name, std::size_t value, std::size_t limit,
                                  std::string_view unit) {
  throw Failure(ErrorCode::TooLarge, name + ": " + std::to_string(value) + " " + std::string(unit) +
                                         " exceed " + std::to_string(limit));
}

std::string to_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end.ptr};
}

/// Linear scan that bounds the parser's memory and nesting.
void check_structure(std::string_view text, const std::string& what) {
  if (text.size() > kMaxDocumentBytes)
    throw_too_large(what, text.size(), kMaxDocumentBytes, "bytes");
  std::size_t values = 1;
  std::size_t depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_text = false;
    } else if (c == '"') {
      in_text = true;
    } else if (c == ',') {
      ++values;
    } else if (c == '[' || c == '{') {
      ++values;
      if (++depth > kMaxDocumentDepth)
        throw_too_large(what, depth, kMaxDocumentDepth, "nested levels");
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  if (values > kMaxDocumentValues)
    throw_too_large(what, values, kMaxDocumentValues, "values");
}

}  // namespace

Document::Document(std::string_view text, std::string_view what) : what_(what) {
  check_structure(text, what_);
  try {
    json_ = std::make_unique<nlohmann::json>(nlohmann::json::parse(text));
  } catch (const nlohmann::json::parse_error& error) {
    throw Failure(ErrorCode::InvalidInput,
                  what_ + ": not JSON at byte " + std::to_string(error.byte));
  } catch (const nlohmann::json::exception&) {
    throw Failure(ErrorCode::InvalidInput, what_ + ": a number is too large for a double");
  }
}

Document::~Document() = default;

Reader Document::root() const {
  if (!json_->is_object())
    throw Failure(ErrorCode::InvalidInput, what_ + ": must be an object, is " + json_->type_name());
  return {*json_, ""};
}

void check_format(const Reader& root, const Format& read) {
  constexpr std::size_t kMaxFormatBytes = 100;
  const auto member = root.find("format");
  if (!member)
    return;
  const std::string given = member->text(kMaxFormatBytes), ours = to_text(read);
  const std::size_t slash = ours.rfind('/') + 1;
  const std::string_view text(given);
  std::uint32_t version = 0;
  const auto [end, error] = std::from_chars(text.data() + std::min(slash, text.size()),
                                            text.data() + text.size(), version);
  if (text.substr(0, slash) != std::string_view(ours).substr(0, slash) || error != std::errc() ||
      end != text.data() + text.size() || version == 0)
    member->refuse("'" + shown(given) + "' is not '" + ours + "'");
  if (version > read.version)
    member->refuse("'" + shown(given) + "' is newer than '" + ours +
                   "', the newest that this program reads");
}

Reader Document::any_root() const { return {*json_, what_}; }

void Reader::refuse(const std::string& problem) const {
  throw Failure(ErrorCode::InvalidInput, name_ + ": " + problem);
}

Reader Reader::at(std::string_view key) const {
  if (!value_->is_object())
    refuse(std::string("must be an object, is ") + value_->type_name());
  std::string name = name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  const auto member = value_->find(key);
  if (member == value_->end())
    throw Failure(ErrorCode::InvalidInput, name + ": is missing");
  return {*member, std::move(name)};
}

std::optional<Reader> Reader::find(std::string_view key) const {
  if (!value_->is_object())
    refuse(std::string("must be an object, is ") + value_->type_name());
  const auto member = value_->find(key);
  if (member == value_->end() || member->is_null())
    return std::nullopt;
  return at(key);
}

void Reader::allow_only(std::initializer_list<std::string_view> members) const {
  for (const std::string& key : keys(kMaxDocumentValues))
    if (std::find(members.begin(), members.end(), key) == members.end())
      throw Failure(ErrorCode::InvalidInput, (name_.empty() ? "" : name_ + ": ") +
                                                 "has an unknown member '" +
                                                 key.substr(0, kMaxLabelBytes) + "'");
}

std::vector<std::string> Reader::keys(std::size_t max_count) const {
  if (!value_->is_object())
    refuse(std::string("must be an object, is ") + value_->type_name());
  if (value_->size() > max_count)
    throw_too_large(name_, value_->size(), max_count, "members");
  std::vector<std::string> names;
  for (auto member = value_->begin(); member != value_->end(); ++member)
    names.push_back(member.key());
  return names;
}

void Reader::require_array(std::size_t max_count) const {
  if (!value_->is_array())
    refuse(std::string("must be an array, is ") + value_->type_name());
  if (value_->size() > max_count)
    throw_too_large(name_, value_->size(), max_count, "elements");
}

std::vector<Reader> Reader::elements(std::size_t max_count) const {
  require_array(max_count);
  std::vector<Reader> readers;
  readers.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i)
    readers.emplace_back((*value_)[i], name_ + "[" + std::to_string(i) + "]");
  return readers;
}

bool Reader::is_null() const { return value_->is_null(); }

bool Reader::is_object() const { return value_->is_object(); }

bool Reader::boolean() const {
  if (!value_->is_boolean())
    refuse(std::string("must be true or false, is ") + value_->type_name());
  return value_->get<bool>();
}

double Reader::number(double lowest, double highest) const {
  if (!value_->is_number())
    refuse(std::string("must be a number, is ") + value_->type_name());
  const double number = value_->get<double>();
  if (!std::isfinite(number))
    refuse("is not finite");
  if (number < lowest)
    refuse(to_text(number) + " is below " + to_text(lowest));
  if (number > highest)
    refuse(to_text(number) + " exceeds " + to_text(highest));
  return number;
}

std::uint64_t Reader::count(std::uint64_t highest) const {
  if (!value_->is_number_unsigned())
    refuse("must be an integer from 0 to 2^64 - 1");  // nlohmann keeps -1 and 1.0 apart from 1
  const auto count = value_->get<std::uint64_t>();
  if (count > highest)
    refuse(std::to_string(count) + " exceeds " + std::to_string(highest));
  return count;
}

std::int64_t Reader::integer() const {
  constexpr auto kHighest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!value_->is_number_integer() ||
      (value_->is_number_unsigned() && value_->get<std::uint64_t>() > kHighest))
    refuse("must be an integer of 64 bits");
  return value_->get<std::int64_t>();
}

std::string Reader::text(std::size_t max_bytes) const {
  if (!value_->is_string())
    refuse(std::string("must be a string, is ") + value_->type_name());
  const auto& text = value_->get_ref<const std::string&>();
  if (text.size() > max_bytes)
    throw_too_large(name_, text.size(), max_bytes, "bytes");
  return text;
}

Digest Reader::digest() const {
  const std::string hex = text(kMaxDocumentBytes);
  const auto digest = Digest::from_hex(hex);
  if (!digest)
    refuse("'" + shown(hex) + "' is not 64 hexadecimal digits");
  return *digest;
}

Uuid Reader::uuid() const {
  const std::string written = text(kMaxDocumentBytes);
  const auto uuid = Uuid::parse(written);
  if (!uuid)
    refuse("'" + shown(written) + "' is not a UUID (8-4-4-4-12)");
  return *uuid;
}

Eigen::Isometry3d Reader::pose() const {
  const Eigen::VectorXd numbers = vector(7);
  PoseArray array{};
  if (static_cast<std::size_t>(numbers.size()) != array.size())
    refuse(std::to_string(numbers.size()) + " numbers, must be 7: x y z qx qy qz qw");
  for (std::size_t i = 0; i < array.size(); ++i)
    array[i] = numbers[static_cast<Eigen::Index>(i)];
  const auto pose = from_pose_array(array);
  if (!pose)
    refuse(pose.error().message);
  return *pose;
}

double Reader::number_at(std::size_t index) const {
  const nlohmann::json& element = (*value_)[index];
  if (element.is_number()) {
    const double number = element.get<double>();
    if (std::isfinite(number))
      return number;
  }
  return Reader(element, name_ + "[" + std::to_string(index) + "]").number();  // names the place
}

Eigen::VectorXd Reader::vector(std::size_t max_size) const {
  require_array(max_size);
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(value_->size()));
  for (Eigen::Index i = 0; i < numbers.size(); ++i)
    numbers[i] = number_at(static_cast<std::size_t>(i));
  return numbers;
}

Eigen::MatrixXd Reader::columns(std::size_t max_rows, std::size_t max_columns) const {
  require_array(max_columns);
  const auto count = static_cast<Eigen::Index>(value_->size());
  Eigen::MatrixXd matrix(0, count);
  for (Eigen::Index column = 0; column < count; ++column) {
    const auto index = static_cast<std::size_t>(column);
    const Reader inner((*value_)[index], name_ + "[" + std::to_string(index) + "]");
    inner.require_array(max_rows);
    const auto rows = static_cast<Eigen::Index>(inner.value_->size());
    if (column == 0)
      matrix.resize(rows, count);
    if (rows != matrix.rows())
      inner.refuse(std::to_string(rows) + " numbers, the first has " +
                   std::to_string(matrix.rows()));
    for (Eigen::Index row = 0; row < rows; ++row)
      matrix(row, column) = inner.number_at(static_cast<std::size_t>(row));
  }
  return matrix;
}

}  // namespace kinship::json
