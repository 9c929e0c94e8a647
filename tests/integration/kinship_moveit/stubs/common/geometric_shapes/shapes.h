#pragma once

#include <memory>

namespace octomap {
class OcTree;
}

namespace shapes {

enum ShapeType { UNKNOWN_SHAPE, SPHERE, CYLINDER, CONE, BOX, PLANE, MESH, OCTREE };

class Shape {
 public:
  explicit Shape(ShapeType its_type) : type(its_type) {}
  virtual ~Shape() = default;
  ShapeType type;
};
using ShapeConstPtr = std::shared_ptr<const Shape>;

struct Sphere : Shape {
  explicit Sphere(double r) : Shape(SPHERE), radius(r) {}
  double radius;
};
struct Cylinder : Shape {
  Cylinder(double r, double l) : Shape(CYLINDER), length(l), radius(r) {}
  double length, radius;
};
struct Cone : Shape {
  Cone(double r, double l) : Shape(CONE), length(l), radius(r) {}
  double length, radius;
};
struct Box : Shape {
  Box(double x, double y, double z) : Shape(BOX), size{x, y, z} {}
  double size[3];
};
struct Plane : Shape {
  Plane(double pa, double pb, double pc, double pd) : Shape(PLANE), a(pa), b(pb), c(pc), d(pd) {}
  double a, b, c, d;
};
struct Mesh : Shape {
  Mesh(unsigned int corners, unsigned int faces)
      : Shape(MESH),
        vertex_count(corners),
        vertices(new double[3 * corners]),
        triangle_count(faces),
        triangles(new unsigned int[3 * faces]) {}
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;
  ~Mesh() override {
    delete[] vertices;
    delete[] triangles;
  }
  unsigned int vertex_count;
  double* vertices;
  unsigned int triangle_count;
  unsigned int* triangles;
};
struct OcTree : Shape {
  explicit OcTree(std::shared_ptr<const octomap::OcTree> tree)
      : Shape(OCTREE), octree(std::move(tree)) {}
  std::shared_ptr<const octomap::OcTree> octree;
};

}  // namespace shapes
