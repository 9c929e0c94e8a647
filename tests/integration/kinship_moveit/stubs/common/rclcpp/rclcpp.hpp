#pragma once

#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

/// What client/ros2/kinship_moveit uses of rclcpp: parameters of a node, and a logger that writes
/// to standard error.
namespace rclcpp {

class Logger {
 public:
  explicit Logger(std::string name) : name_(std::move(name)) {}
  template <typename... Values>
  void write(const char* level, const char* format, Values... values) const {
    std::fprintf(stderr, "[%s] [%s]: ", level, name_.c_str());
    std::fprintf(stderr, format, values...);
    std::fputc('\n', stderr);
  }

 private:
  std::string name_;
};

inline Logger get_logger(const std::string& name) { return Logger(name); }

#define RCLCPP_INFO(logger, ...) (logger).write("INFO", __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) (logger).write("WARN", __VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) (logger).write("ERROR", __VA_ARGS__)

class Node {
 public:
  using SharedPtr = std::shared_ptr<Node>;
  using Value =
      std::variant<bool, long, double, std::string, std::vector<std::string>, std::vector<double>>;

  bool has_parameter(const std::string& name) const { return values_.count(name) != 0; }
  template <typename T>
  void declare_parameter(const std::string& name, const T& value) {
    if (has_parameter(name))
      throw std::logic_error(name + " is declared already");
    set(name, value);
  }
  template <typename T>
  bool get_parameter(const std::string& name, T& value) const {
    const auto known = values_.find(name);
    if (known == values_.end())
      return false;
    value = static_cast<T>(std::get<typename Kept<T>::Type>(known->second));
    return true;
  }
  template <typename T>
  void set(const std::string& name, const T& value) {
    values_[name] = static_cast<typename Kept<T>::Type>(value);
  }

 private:
  template <typename T, typename = void>
  struct Kept {
    using Type = T;
  };
  template <typename Unused>
  struct Kept<int, Unused> {
    using Type = long;
  };

  std::map<std::string, Value> values_;
};

}  // namespace rclcpp
