#include "robots/geometry/srdf.hpp"

#include <tinyxml2.h>

#include <map>

#include "proto/types/limits.hpp"

namespace kinship::geometry {
namespace {

Error invalid_in_line(int line, const std::string& message) {
  return {ErrorCode::InvalidInput, "line " + std::to_string(line) + ": " + message};
}

/// The name in an attribute of a disable_collisions element.
Result<std::string> read_link(const tinyxml2::XMLElement& element, const char* attribute) {
  const char* const name = element.Attribute(attribute);
  if (name == nullptr)
    return invalid_in_line(element.GetLineNum(),
                           std::string("disable_collisions has no ") + attribute);
  return std::string(name);
}

/// The links of a robot, and others that a document names beside them.
class KnownLinks {
 public:
  explicit KnownLinks(const kinematics::Chain& chain) : chain_(chain) {}

  /// Whether the robot has both; notes missing ones.
  bool have(const std::string& first, const std::string& second, int line) {
    const bool has_first = has(first, line);
    return (first == second || has(second, line)) && has_first;
  }

  const std::vector<SrdfStranger>& strangers() const { return strangers_; }

 private:
  bool has(const std::string& link, int line) {
    if (chain_.find_link(link) >= 0)
      return true;
    const auto [place, is_new] = places_.try_emplace(link, strangers_.size());
    if (is_new)
      strangers_.push_back({link, line, 0});
    ++strangers_[place->second].pairs;
    return false;
  }

  const kinematics::Chain& chain_;
  std::vector<SrdfStranger> strangers_;
  std::map<std::string, std::size_t> places_;
};

/// XML has no "--" in a comment; a link's name may.
std::string comment_text(const std::string& text) {
  std::string spaced;
  for (const char c : text) {
    if (c == '-' && spaced.ends_with('-'))
      spaced += ' ';
    spaced += c;
  }
  return " " + spaced + " ";
}

}  // namespace

Result<std::vector<std::pair<std::string, std::string>>> read_srdf(
    std::string_view text, const kinematics::Chain& chain, std::vector<SrdfStranger>* strangers) {
  if (text.size() > kMaxSrdfBytes)
    return Error{ErrorCode::TooLarge, "SRDF of " + std::to_string(text.size()) + " bytes exceeds " +
                                          std::to_string(kMaxSrdfBytes)};
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return invalid_in_line(document.ErrorLineNum(), std::string("not well-formed XML: ") +
                                                        document.ErrorIDToName(document.ErrorID()));
  const tinyxml2::XMLElement* const robot = document.FirstChildElement("robot");
  if (robot == nullptr)
    return Error{ErrorCode::InvalidInput, "no <robot> element"};

  constexpr const char* kElement = "disable_collisions";
  std::vector<std::pair<std::string, std::string>> pairs;
  KnownLinks links(chain);
  std::size_t count = 0;
  for (const auto* element = robot->FirstChildElement(kElement); element != nullptr;
       element = element->NextSiblingElement(kElement)) {
    if (++count > kMaxCollisionPairs)
      return Error{ErrorCode::TooLarge,
                   "more than " + std::to_string(kMaxCollisionPairs) + " disable_collisions"};
    auto first = read_link(*element, "link1");
    if (!first)
      return first.error();
    auto second = read_link(*element, "link2");
    if (!second)
      return second.error();
    if (links.have(*first, *second, element->GetLineNum()))
      pairs.emplace_back(*std::move(first), *std::move(second));
  }
  if (strangers != nullptr)
    *strangers = links.strangers();
  return pairs;
}

std::string write_srdf(const std::string& robot, const std::vector<SrdfPair>& pairs,
                       const std::string& comment) {
  tinyxml2::XMLPrinter printer;
  printer.PushHeader(false, true);
  printer.PushComment(comment_text(comment).c_str());
  printer.OpenElement("robot");
  printer.PushAttribute("name", robot.c_str());
  for (const SrdfPair& pair : pairs) {
    printer.OpenElement("disable_collisions");
    printer.PushAttribute("link1", pair.link_a.c_str());
    printer.PushAttribute("link2", pair.link_b.c_str());
    printer.PushAttribute("reason", pair.reason.c_str());
    printer.CloseElement();
  }
  printer.CloseElement();
  return std::string(printer.CStr()) + "\n";
}

}  // namespace kinship::geometry
