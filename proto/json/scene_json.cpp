#include "proto/json/scene_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/scene_names.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxObjects = 4096;
constexpr std::size_t kMaxFileNameBytes = 4096;
constexpr double kMaxScale = 1e6;

template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

/// m
double read_extent(const Reader& reader) {
  const double extent = reader.number();
  if (extent < std::numeric_limits<double>::min())
    reader.refuse(number_text(extent) + " m, must be above 0");
  if (extent > kMaxPlacement_m)
    reader.refuse(number_text(extent) + " m exceeds " + number_text(kMaxPlacement_m) +
                  " m; these are probably millimetres");
  return extent;
}

Eigen::Vector3d read_size(const Reader& reader) {
  const auto elements = reader.elements(3);
  if (elements.size() != 3)
    reader.refuse(std::to_string(elements.size()) + " extents, must be 3");
  return {read_extent(elements[0]), read_extent(elements[1]), read_extent(elements[2])};
}

/// [radius, length]
std::pair<double, double> read_round(const Reader& reader) {
  const auto elements = reader.elements(2);
  if (elements.size() != 2)
    reader.refuse("must be [radius, length]");
  return {read_extent(elements[0]), read_extent(elements[1])};
}

Eigen::Isometry3d read_center(const Reader& reader) {
  const Eigen::VectorXd center = reader.vector(3);
  if (center.size() != 3 || center.cwiseAbs().maxCoeff() > kMaxPlacement_m)
    reader.refuse("must be 3 coordinates of at most " + std::to_string(kMaxPlacement_m) + " m");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = center;
  return T;
}

std::string read_file_name(const Reader& file) {
  std::string name = file.text(kMaxFileNameBytes);
  if (name.empty())
    file.refuse("is empty");
  return name;
}

/// A mesh without its triangles: reading files is not for this library.
Mesh read_mesh(const Reader& file, const std::optional<Reader>& scale) {
  Mesh mesh;
  mesh.file = read_file_name(file);
  if (scale) {
    const auto factors = scale->elements(3);
    if (factors.size() != 3)
      scale->refuse(std::to_string(factors.size()) + " factors, must be 3");
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Reader& factor = factors[static_cast<std::size_t>(i)];
      mesh.scale[i] = factor.number(-kMaxScale, kMaxScale);  // below 0: mirrored
      if (mesh.scale[i] == 0)
        factor.refuse("is 0, which makes the mesh flat");
    }
  }
  return mesh;
}

/// Calls read(element) for each element of an optional list and collects the results.
template <typename Read>
void read_objects(const Reader& reader, std::string_view key, Scene& scene, Read read) {
  const auto objects = reader.find(key);
  if (!objects)
    return;
  for (const Reader& element : objects->elements(kMaxObjects)) {
    SceneObject object = read(element);
    object.name = read_name(element.at("name"));
    if (const auto approximate = element.find("approximate"))
      object.approximate = approximate->boolean();
    scene.objects.push_back(std::move(object));
  }
}

}  // namespace

std::string read_name(const Reader& reader) {
  std::string name = reader.text(kMaxLinkNameBytes);
  if (name.empty())
    reader.refuse("is empty");
  return name;
}

Shape read_shape(const Reader& reader) {
  if (reader.find("mesh"))
    reader.refuse("is a mesh: only shapes are kept here");
  if (const auto box = reader.find("box"))
    return BoxShape{read_size(*box)};
  if (const auto sphere = reader.find("sphere"))
    return SphereShape{read_extent(*sphere)};
  if (const auto cylinder = reader.find("cylinder")) {
    const auto [radius_m, length_m] = read_round(*cylinder);
    return CylinderShape{radius_m, length_m};
  }
  if (const auto capsule = reader.find("capsule")) {
    const auto [radius_m, length_m] = read_round(*capsule);
    return CapsuleShape{radius_m, length_m};
  }
  reader.refuse("must be one of box, cylinder, sphere, capsule");
}

OrderedJson shape_object(const Shape& shape) {
  OrderedJson object;
  std::visit(Overloaded{[&](const BoxShape& box) { object["box"] = list(box.size); },
                        [&](const CylinderShape& cylinder) {
                          object["cylinder"] = {cylinder.radius_m, cylinder.length_m};
                        },
                        [&](const SphereShape& sphere) { object["sphere"] = sphere.radius_m; },
                        [&](const CapsuleShape& capsule) {
                          object["capsule"] = {capsule.radius_m, capsule.length_m};
                        }},
             shape);
  return object;
}

OrderedJson scene_object(const Scene& scene) {
  OrderedJson document;
  for (const char* key : {"boxes", "cylinders", "spheres", "capsules"})
    document[key] = OrderedJson::array();
  for (const SceneObject& object : scene.objects) {
    OrderedJson entry;
    entry["name"] = object.name;
    if (object.approximate)
      entry["approximate"] = true;
    const auto add_round = [&](const char* key, double radius_m, double length_m) {
      entry["pose"] = pose_list(object.T_task_object);
      entry["radius"] = radius_m;
      entry["length"] = length_m;
      document[key].push_back(entry);
    };
    std::visit(Overloaded{[&](const BoxShape& box) {
                            entry["pose"] = pose_list(object.T_task_object);
                            entry["size"] = list(box.size);
                            document["boxes"].push_back(entry);
                          },
                          [&](const CylinderShape& cylinder) {
                            add_round("cylinders", cylinder.radius_m, cylinder.length_m);
                          },
                          [&](const SphereShape& sphere) {
                            entry["center"] = list(object.T_task_object.translation());
                            entry["radius"] = sphere.radius_m;
                            document["spheres"].push_back(entry);
                          },
                          [&](const CapsuleShape& capsule) {
                            add_round("capsules", capsule.radius_m, capsule.length_m);
                          }},
               object.shape);
  }
  for (const SceneMesh& object : scene.meshes) {
    OrderedJson entry;
    entry["name"] = object.name;
    entry["file"] = object.mesh.file;
    entry["pose"] = pose_list(object.T_task_mesh);
    entry["scale"] = list(object.mesh.scale);
    document["meshes"].push_back(std::move(entry));
  }
  for (const SceneCloud& object : scene.clouds) {
    OrderedJson entry;
    entry["name"] = object.name;
    entry["file"] = object.cloud.file;
    entry["pose"] = pose_list(object.T_task_cloud);
    entry["voxel"] = object.cloud.voxel_m;
    document["clouds"].push_back(std::move(entry));
  }
  return document;
}

Scene read_scene(const Reader& reader) {
  reader.allow_only({"boxes", "cylinders", "spheres", "capsules", "meshes", "clouds"});
  Scene scene = read_solids(reader);
  if (const auto meshes = reader.find("meshes"))
    for (const Reader& mesh : meshes->elements(kMaxObjects)) {
      mesh.allow_only({"name", "file", "pose", "scale"});
      scene.meshes.push_back({read_name(mesh.at("name")),
                              read_mesh(mesh.at("file"), mesh.find("scale")),
                              mesh.at("pose").pose()});
    }
  if (const auto clouds = reader.find("clouds"))
    for (const Reader& cloud : clouds->elements(kMaxObjects)) {
      cloud.allow_only({"name", "file", "pose", "voxel"});
      SceneCloud object{read_name(cloud.at("name")), {}, cloud.at("pose").pose()};
      object.cloud.file = read_file_name(cloud.at("file"));
      if (const auto voxel = cloud.find("voxel"))
        object.cloud.voxel_m = voxel->number(kMinVoxel_m, kMaxVoxel_m);
      scene.clouds.push_back(std::move(object));
    }
  if (const auto name = find_repeated_name(scene))
    reader.refuse("two objects are named '" + *name + "': each needs a name of its own");
  return scene;
}

Scene read_solids(const Reader& reader) {
  Scene scene;
  read_objects(reader, "boxes", scene, [](const Reader& box) {
    return SceneObject{"", BoxShape{read_size(box.at("size"))}, box.at("pose").pose()};
  });
  read_objects(reader, "cylinders", scene, [](const Reader& cylinder) {
    const CylinderShape shape{read_extent(cylinder.at("radius")),
                              read_extent(cylinder.at("length"))};
    return SceneObject{"", shape, cylinder.at("pose").pose()};
  });
  read_objects(reader, "spheres", scene, [](const Reader& sphere) {
    return SceneObject{"", SphereShape{read_extent(sphere.at("radius"))},
                       read_center(sphere.at("center"))};
  });
  read_objects(reader, "capsules", scene, [](const Reader& capsule) {
    const CapsuleShape shape{read_extent(capsule.at("radius")), read_extent(capsule.at("length"))};
    return SceneObject{"", shape, capsule.at("pose").pose()};
  });
  return scene;
}

OrderedJson attached_object(const AttachedObject& attached) {
  OrderedJson object;
  object["name"] = attached.name;
  object["link"] = attached.link;
  object["shape"] = attached.mesh ? OrderedJson{{"mesh", attached.mesh->file},
                                                {"scale", list(attached.mesh->scale)}}
                                  : shape_object(attached.shape);
  object["T_link_object"] = pose_list(attached.T_link_object);
  object["touch_links"] = attached.touch_links;
  return object;
}

AttachedObject read_attached(const Reader& reader) {
  AttachedObject attached;
  attached.name = read_name(reader.at("name"));
  attached.link = read_name(reader.at("link"));
  const Reader shape = reader.at("shape");
  if (const auto file = shape.find("mesh"))
    attached.mesh = read_mesh(*file, shape.find("scale"));
  else
    attached.shape = read_shape(shape);
  attached.T_link_object = reader.at("T_link_object").pose();
  if (const auto links = reader.find("touch_links"))
    for (const Reader& link : links->elements(kMaxCollisionPairs))
      attached.touch_links.push_back(read_name(link));
  return attached;
}

}  // namespace kinship::json
