#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>

namespace kinship::test {

/// A box as twelve triangles, from the origin to its opposite corner, in every format that is read.
class BoxMesh {
 public:
  explicit BoxMesh(const Eigen::Vector3d& size) {
    for (int i = 0; i < 8; ++i)
      corners_.at(static_cast<std::size_t>(i)) =
          Eigen::Vector3d(i & 1 ? size.x() : 0, i & 2 ? size.y() : 0, i & 4 ? size.z() : 0);
  }

  /// 3 x 36, three columns a triangle.
  Eigen::Matrix3Xd triangles() const {
    Eigen::Matrix3Xd columns(3, 3 * static_cast<Eigen::Index>(kTriangles.size()));
    Eigen::Index column = 0;
    for (const auto& triangle : kTriangles)
      for (const std::size_t corner : triangle)
        columns.col(column++) = corners_.at(corner);
    return columns;
  }

  std::string binary_stl() const {
    std::string bytes(80, ' ');
    append(bytes, static_cast<std::uint32_t>(kTriangles.size()));
    for (const auto& triangle : kTriangles) {
      for (int i = 0; i < 3; ++i)
        append(bytes, 0.0F);  // a normal that readers compute anew
      for (const std::size_t corner : triangle)
        for (const double coordinate : corners_.at(corner))
          append(bytes, static_cast<float>(coordinate));
      append(bytes, std::uint16_t{0});
    }
    return bytes;
  }

  std::string text_stl() const {
    std::ostringstream text;
    text << "solid box\n";
    for (const auto& triangle : kTriangles) {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const std::size_t corner : triangle)
        text << "vertex " << corners_.at(corner).transpose() << '\n';
      text << "endloop\nendfacet\n";
    }
    text << "endsolid box\n";
    return text.str();
  }

  std::string obj() const {
    std::ostringstream text;
    for (const Eigen::Vector3d& corner : corners_)
      text << "v " << corner.transpose() << '\n';
    for (const auto& triangle : kTriangles)
      text << "f " << triangle[0] + 1 << ' ' << triangle[1] + 1 << ' ' << triangle[2] + 1 << '\n';
    return text.str();
  }

  /// \param unit_m  of the coordinates.
  /// \param up      X_UP, Y_UP or Z_UP.
  /// \param matrix  of the node, 16 numbers by rows.
  std::string dae(double unit_m = 1, const std::string& up = "Z_UP",
                  const std::string& matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1") const {
    std::ostringstream text;
    text << R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="own" meter=")"
         << unit_m << "\"/><up_axis>" << up << R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="24">)";
    for (const Eigen::Vector3d& corner : corners_)
      text << corner.transpose() << ' ';
    text << R"(</float_array><technique_common><accessor source="#a" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)";
    for (const auto& triangle : kTriangles)
      text << triangle[0] << ' ' << triangle[1] << ' ' << triangle[2] << ' ';
    text << R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>)"
         << matrix << R"(</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
    return text.str();
  }

 private:
  static constexpr std::array<std::array<std::size_t, 3>, 12> kTriangles = {{{0, 2, 1},
                                                                             {1, 2, 3},
                                                                             {4, 5, 6},
                                                                             {5, 7, 6},
                                                                             {0, 1, 4},
                                                                             {1, 5, 4},
                                                                             {2, 6, 3},
                                                                             {3, 6, 7},
                                                                             {0, 4, 2},
                                                                             {2, 4, 6},
                                                                             {1, 3, 5},
                                                                             {3, 7, 5}}};

  template <typename T>
  static void append(std::string& bytes, T value) {  // these machines are little-endian, as STL is
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  }

  std::array<Eigen::Vector3d, 8> corners_;
};

}  // namespace kinship::test
