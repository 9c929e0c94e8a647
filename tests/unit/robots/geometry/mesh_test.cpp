#include "robots/geometry/mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <string>

#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::mesh_test {
namespace {

const Eigen::Vector3d kSize(0.25, 0.5, 2);
const test::BoxMesh kBox(kSize);

/// The smallest and largest corner, or the message.
std::string extents(std::string_view bytes, std::string_view format) {
  const auto corners = read_mesh(bytes, format);
  if (!corners)
    return corners.error().message;
  std::ostringstream text;
  text << corners->rowwise().minCoeff().transpose() << " to "
       << corners->rowwise().maxCoeff().transpose();
  return text.str();
}

const std::string kExtents = "0 0 0 to 0.25  0.5    2";

TEST(ReadMesh, ReadsEveryFormat) {
  EXPECT_EQ(extents(kBox.binary_stl(), "stl"), kExtents);
  EXPECT_EQ(extents(kBox.text_stl(), "stl"), kExtents);
  EXPECT_EQ(extents(kBox.obj(), "obj"), kExtents);
  EXPECT_EQ(extents(kBox.dae(), "dae"), kExtents);
}

TEST(ReadMesh, GivesThreeCornersATriangle) {
  for (const auto& [bytes, format] :
       {std::pair(kBox.binary_stl(), "stl"), std::pair(kBox.text_stl(), "stl"),
        std::pair(kBox.obj(), "obj"), std::pair(kBox.dae(), "dae")}) {
    const auto triangles = read_mesh(bytes, format);
    ASSERT_TRUE(triangles) << format;
    ASSERT_EQ(triangles->cols(), 36) << format;
    double area_m2 = 0;
    for (Eigen::Index i = 0; i < triangles->cols(); i += 3) {
      const Eigen::Vector3d a = triangles->col(i), b = triangles->col(i + 1),
                            c = triangles->col(i + 2);
      area_m2 += (b - a).cross(c - a).norm() / 2;
    }
    EXPECT_NEAR(area_m2, 2 * (0.25 * 0.5 + 0.25 * 2 + 0.5 * 2), 1e-6) << format;
  }
}

TEST(ReadMesh, EndingsMayBeInCapitals) {
  EXPECT_EQ(extents(kBox.binary_stl(), "STL"), kExtents);
  EXPECT_EQ(extents(kBox.obj(), "Obj"), kExtents);
  EXPECT_EQ(extents(kBox.dae(), "DAE"), kExtents);
}

TEST(ReadMesh, AppliesTheUnitOfADaeFileButNotItsUpAxis) {
  EXPECT_EQ(extents(test::BoxMesh(1000 * kSize).dae(0.001), "dae"), kExtents);
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"})
    EXPECT_EQ(extents(kBox.dae(1, up), "dae"), kExtents) << up;
}

TEST(ReadMesh, PutsMeshesWhereTheNodesOfADaeFilePutThem) {
  EXPECT_EQ(extents(kBox.dae(1, "Z_UP", "0 -1 0 0 1 0 0 0 0 0 1 5 0 0 0 1"), "dae"),
            "-0.5    0    5 to    0 0.25    7");
}

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

TEST(ReadMesh, KeywordsOfATextStlMayBeInCapitalsAndBeginLate) {
  EXPECT_EQ(extents(in_capitals(kBox.text_stl()), "stl"), kExtents);
  EXPECT_EQ(extents("SOLID" + kBox.text_stl().substr(5), "stl"), kExtents);
  EXPECT_EQ(extents("\r\n  " + kBox.text_stl(), "stl"), kExtents);
  EXPECT_EQ(read_mesh(kBox.text_stl() + kBox.text_stl(), "stl").value_or_throw().cols(), 72);
}

TEST(ReadMesh, ABinaryStlIsOneWhateverItsHeaderSays) {
  for (const std::string title : {"solid box", "SOLID", "solid\nfacet normal 0 0 0", "solid\n\n"})
    EXPECT_EQ(extents(kBox.binary_stl().replace(0, title.size(), title), "stl"), kExtents) << title;
}

TEST(ReadMesh, TextAndBinaryStlAreTheSameTriangles) {
  const test::BoxMesh box({0.1, 1.0 / 3, 7e-3});
  EXPECT_EQ(read_mesh(box.text_stl(), "stl").value_or_throw().cols(), 36);
  EXPECT_TRUE(read_mesh(box.text_stl(), "stl")
                  .value_or_throw()
                  .isApprox(read_mesh(box.binary_stl(), "stl").value_or_throw(), 1e-5));
}

TEST(ReadMesh, BytesBehindTheFacetsOfABinaryStlHideNone) {
  for (const std::string title : {"box", "solid box"}) {
    const std::string whole = kBox.binary_stl().replace(0, title.size(), title);
    EXPECT_EQ(extents(whole + "\n", "stl"), kExtents);
    EXPECT_EQ(extents(whole + "made by hand", "stl"), kExtents);
    EXPECT_EQ(extents(whole + std::string(428, '\0'), "stl"), kExtents);
    EXPECT_EQ(extents(whole + whole.substr(84, 50), "stl"),
              "announces 12 triangles, and 50 bytes follow them: there may be more");
    EXPECT_EQ(extents(whole.substr(0, whole.size() - 1), "stl"),
              "announces 12 triangles and holds 11: it is cut off, or no STL");
  }
}

TEST(ReadMesh, NamesTheLineOfATextStlThatIsWrong) {
  const std::string whole = kBox.text_stl();
  const auto with = [&](const std::string& what, const std::string& other) {
    std::string text = whole;
    return extents(text.replace(text.find(what), what.size(), other), "stl");
  };
  EXPECT_EQ(with("vertex 0 0 0", "vertex 0,5 0 0"),
            "line 4: a number is expected (decimal commas are not read), not '0,5'");
  EXPECT_EQ(with("vertex 0 0 0", "vertex 0 0"), "line 5: a number is expected, not 'vertex'");
  EXPECT_EQ(with("endloop", "vertex 0 0 0\nendloop"),
            "line 7: 'endloop' is expected, not 'vertex'");
  EXPECT_EQ(extents(whole.substr(0, whole.find("endsolid")), "stl"),
            "line 86: 'facet' is expected, and the file ends here: is it cut off?");
}

TEST(ReadMesh, NamesTheLineOfAnObjVertexThatIsReadAsAnother) {
  const auto with = [](const std::string& vertex) {
    return extents("# a triangle\nv 1 0 0\nv 0 1 0\n" + vertex + "\nf 1 2 3\n", "obj");
  };
  for (const std::string vertex : {"v 0 0 1", "v\t0  +0\t1.0e0 \r", "v 0 0 1 # top", "v 0 0 1 1",
                                   "v 0 0 \\\n1", "v 0 0 1 0.5 0.5 0.5"})
    EXPECT_EQ(with(vertex), "0 0 0 to 1 1 1") << vertex;
  for (const std::string word : {"0,5", "1,000.5", "1,2,3", "0.5,"})
    EXPECT_EQ(with("v " + word + " 0 0"),
              "line 4: '" + word +
                  "' is no number; decimal commas are not read, and only blanks and tabs part "
                  "numbers");
  for (const std::string word : {"0.5x", "0x10", "1;2", "1.000e"})
    EXPECT_EQ(with("v 0 0 " + word), "line 4: '" + word + "' is no number");
}

TEST(ReadMesh, NamesTheLineOfACommaInADaeFile) {
  const std::string whole = kBox.dae();
  const auto with = [&](const std::string& what, const std::string& other) {
    std::string text = whole;
    return extents(text.replace(text.find(what), what.size(), other), "dae");
  };
  const std::string why =
      "' is no number; decimal commas are not read, and only blanks and tabs part numbers";
  EXPECT_EQ(with("\"24\">0 ", "\"24\">0,5 "), "line 5: '0,5" + why);
  EXPECT_EQ(with("\"24\">0 0 0 ", "\"24\">\n0.5,0,0\n"), "line 6: '0.5,0,0" + why);
  EXPECT_EQ(with("1 0 0 0 0 1", "1 0 0 0,5 0 1"), "line 10: '0,5" + why);
  EXPECT_EQ(with("meter=\"1\"", "meter=\"0,001\""), "line 3: '0,001" + why);
  EXPECT_EQ(with("name=\"own\"", "name=\"metre, SI\""), kExtents);
}

TEST(ReadMesh, RefusesOtherFormats) {
  EXPECT_EQ(extents("ply\n", "ply"), "format 'ply' is not one of stl, obj, dae");
  EXPECT_EQ(extents("", ""), "format '' is not one of stl, obj, dae");
}

TEST(ReadMesh, RefusesWhatIsNoMesh) {
  for (const char* format : {"stl", "obj", "dae"})
    for (const std::string& bytes : {std::string(), std::string("x"), std::string(1000, '\xff'),
                                     std::string("<?xml version='1.0'?><a/>")}) {
      const auto corners = read_mesh(bytes, format);
      ASSERT_FALSE(corners) << format;
      EXPECT_EQ(corners.error().code, ErrorCode::InvalidInput);
    }
  EXPECT_EQ(extents("v 0 0 0\nv 1 0 0\nl 1 2\n", "obj"), "holds no triangles");
}

TEST(ReadMesh, RefusesATruncatedFile) {
  const std::string whole = kBox.binary_stl();
  EXPECT_NE(extents(whole.substr(0, whole.size() / 2), "stl"), kExtents);
  EXPECT_FALSE(read_mesh(whole.substr(0, whole.size() / 2), "stl"));
  EXPECT_FALSE(read_mesh(kBox.dae().substr(0, 700), "dae"));
}

TEST(ReadMesh, RefusesCoordinatesThatAreNotFinite) {
  std::string bytes = kBox.binary_stl();
  bytes.replace(84 + 12, 4, std::string("\x00\x00\xc0\x7f", 4));  // the first coordinate: NaN
  EXPECT_EQ(extents(bytes, "stl"), "holds a coordinate that is not finite");
}

TEST(ReadMesh, RefusesTooManyBytesAndTriangles) {
  const auto too_long = read_mesh(std::string(kMaxMeshBytes + 1, ' '), "stl");
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, ErrorCode::TooLarge);
  EXPECT_EQ(too_long.error().message, "64000001 bytes exceed 64000000");

  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";  // one polygon of many corners
  many += "f";
  for (std::size_t i = 0; i < kMaxMeshTriangles + 3; ++i)
    many += " 1";
  const auto polygon = read_mesh(many, "obj");
  ASSERT_FALSE(polygon);
  EXPECT_EQ(polygon.error().code, ErrorCode::TooLarge) << polygon.error().message;
  EXPECT_EQ(polygon.error().message, "2000001 triangles or more exceed 2000000");
}

TEST(ReadMesh, DoesNotExpandEntitiesOfADaeFile) {
  std::string bomb = "<?xml version='1.0'?><!DOCTYPE COLLADA [<!ENTITY a0 'x'>";
  for (int i = 1; i < 40; ++i)
    bomb += "<!ENTITY a" + std::to_string(i) + " '&a" + std::to_string(i - 1) + ";&a" +
            std::to_string(i - 1) + ";'>";
  bomb += "]><COLLADA>&a39;</COLLADA>";
  EXPECT_FALSE(read_mesh(bomb, "dae"));
}

}  // namespace
}  // namespace kinship::geometry::mesh_test
