#include "server/metrics/exposition.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace kinship::metrics {
namespace {

std::string_view word_of(Type type) {
  switch (type) {
    case Type::Counter:
      return "counter";
    case Type::Gauge:
      return "gauge";
    case Type::Histogram:
      return "histogram";
  }
  return "untyped";
}

/// Of a metric or label: [a-z_][a-z0-9_]*, which is stricter than Prometheus.
bool is_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

std::string number(double value) {
  if (std::isnan(value))
    return "NaN";
  if (std::isinf(value))
    return value > 0 ? "+Inf" : "-Inf";
  // Bounds of buckets as is usual: 0.0001, not 1e-04.
  constexpr double kPlainFrom = 1e-4, kPlainTo = 1e15;
  const double size = std::abs(value);
  const bool is_plain = size == 0 || (size >= kPlainFrom && size < kPlainTo);
  char text[64];
  const auto format = is_plain ? std::chars_format::fixed : std::chars_format::scientific;
  return {text, std::to_chars(text, text + sizeof text, value, format).ptr};
}

std::string escaped(std::string_view text, bool is_quoted) {
  std::string safe;
  for (const char c : text) {
    if (c == '\n') {
      safe += "\\n";
      continue;
    }
    if (c == '\\' || (is_quoted && c == '"'))
      safe += '\\';
    safe += c;
  }
  return safe;
}

}  // namespace

void Exposition::family(std::string_view name, Type type, std::string_view help) {
  if (!is_name(name))
    throw std::logic_error("metric '" + std::string(name) + "': no name of a metric");
  if ((type == Type::Counter) != name.ends_with("_total"))
    throw std::logic_error("metric '" + std::string(name) + "': counters end in _total");
  if (!names_.emplace(name).second)
    throw std::logic_error("metric '" + std::string(name) + "': a second family of this name");
  name_ = name;
  type_ = type;
  text_ += "# HELP " + name_ + ' ' + escaped(help, false) + "\n# TYPE " + name_ + ' ';
  text_ += word_of(type);
  text_ += '\n';
}

void Exposition::line(std::string_view suffix, Labels labels, std::string_view bound,
                      std::string_view value) {
  text_ += name_;
  text_ += suffix;
  char before = '{';
  const auto add = [&](std::string_view name, std::string_view label) {
    if (!is_name(name))
      throw std::logic_error("metric '" + name_ + "': '" + std::string(name) + "' is no label");
    text_ += before;
    text_ += name;
    text_ += "=\"" + escaped(label, true) + '"';
    before = ',';
  };
  for (const Label& label : labels)
    add(label.name, label.value);
  if (!bound.empty())
    add("le", bound);
  if (before == ',')
    text_ += '}';
  text_ += ' ';
  text_ += value;
  text_ += '\n';
}

void Exposition::require_samples() const {
  if (name_.empty() || type_ == Type::Histogram)
    throw std::logic_error("metric '" + name_ + "': a sample outside a family of counters, gauges");
}

void Exposition::sample(double value, Labels labels) {
  require_samples();
  line("", labels, "", number(value));
}

void Exposition::sample(std::uint64_t value, Labels labels) {
  require_samples();
  line("", labels, "", std::to_string(value));
}

/// Reads each bucket once, so that the total is the sum of the written ones, also while others
/// observe.
void Exposition::histogram(const Histogram& histogram, Labels labels) {
  if (type_ != Type::Histogram)
    throw std::logic_error("metric '" + name_ + "': a histogram in another family");
  std::uint64_t so_far = 0;
  for (std::size_t i = 0; i < Histogram::kBounds_s.size(); ++i) {
    so_far += histogram.count(i);
    line("_bucket", labels, number(Histogram::kBounds_s[i]), std::to_string(so_far));
  }
  so_far += histogram.count(Histogram::kBounds_s.size());
  line("_bucket", labels, "+Inf", std::to_string(so_far));
  line("_sum", labels, "", number(histogram.sum_s()));
  line("_count", labels, "", std::to_string(so_far));
}

void Exposition::counter(std::string_view name, std::string_view help, std::uint64_t value) {
  family(name, Type::Counter, help);
  sample(value);
}

void Exposition::counter(std::string_view name, std::string_view help, double value) {
  family(name, Type::Counter, help);
  sample(value);
}

void Exposition::gauge(std::string_view name, std::string_view help, std::uint64_t value) {
  family(name, Type::Gauge, help);
  sample(value);
}

void Exposition::gauge(std::string_view name, std::string_view help, double value) {
  family(name, Type::Gauge, help);
  sample(value);
}

}  // namespace kinship::metrics
