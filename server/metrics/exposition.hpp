#pragma once

#include <cstdint>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>

#include "server/metrics/histogram.hpp"

namespace kinship::metrics {

enum class Type { Counter, Gauge, Histogram };

struct Label {
  std::string_view name, value;
};
using Labels = std::initializer_list<Label>;

/// Writes metrics in Prometheus's text format, version 0.0.4
/// (https://prometheus.io/docs/instrumenting/exposition_formats/). NaN and infinities are written
/// as such; label values and help are escaped.
///
/// Names that break its conventions throw std::logic_error: a family twice, a counter without
/// _total, another character than a letter, digit or underscore, a sample of a histogram.
class Exposition {
 public:
  /// Begins a family; the samples that follow belong to it.
  void family(std::string_view name, Type type, std::string_view help);

  void sample(double value, Labels labels = {});
  void sample(std::uint64_t value, Labels labels = {});
  void histogram(const Histogram& histogram, Labels labels = {});

  // A family of one sample without labels.
  void counter(std::string_view name, std::string_view help, std::uint64_t value);
  void counter(std::string_view name, std::string_view help, double value);
  void gauge(std::string_view name, std::string_view help, std::uint64_t value);
  void gauge(std::string_view name, std::string_view help, double value);

  const std::string& text() const noexcept { return text_; }

 private:
  void line(std::string_view suffix, Labels labels, std::string_view bound, std::string_view value);
  void require_samples() const;

  std::set<std::string, std::less<>> names_;
  std::string name_;
  Type type_ = Type::Gauge;
  std::string text_;
};

}  // namespace kinship::metrics
