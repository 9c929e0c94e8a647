#include "robots/geometry/visual_solids.hpp"

#include <tinyxml2.h>

#include <algorithm>

namespace kinship::geometry {
namespace {

void add_collision(const tinyxml2::XMLElement& visual, tinyxml2::XMLElement& link) {
  tinyxml2::XMLDocument& document = *link.GetDocument();
  tinyxml2::XMLElement* const collision = document.NewElement("collision");
  collision->SetAttribute("name", kFromVisual);
  for (const char* part : {"origin", "geometry"})
    if (const tinyxml2::XMLElement* const found = visual.FirstChildElement(part))
      collision->InsertEndChild(found->DeepClone(&document));
  link.InsertEndChild(collision);
}

}  // namespace

Result<std::string> with_visual_solids(const std::string& urdf,
                                       const std::vector<std::string>& except) {
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf.data(), urdf.size()) != tinyxml2::XML_SUCCESS)
    return invalid_input("URDF: line " + std::to_string(document.ErrorLineNum()) +
                         ": not well-formed XML");
  tinyxml2::XMLElement* const robot = document.FirstChildElement("robot");
  if (robot == nullptr)
    return invalid_input("URDF: no <robot> element");
  for (auto* link = robot->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const char* const name = link->Attribute("name");
    if (link->FirstChildElement("collision") != nullptr ||
        (name != nullptr && std::ranges::count(except, name) > 0))
      continue;
    for (const auto* visual = link->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual"))
      add_collision(*visual, *link);
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return std::string(printer.CStr());
}

}  // namespace kinship::geometry
