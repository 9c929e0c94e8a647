"""What an integrator has: a package with an arm whose links are meshes in millimetres, and MoveIt's messages as YAML."""
import math
import re
import struct

from installed_machine import SOURCE, Person

PACKAGE = "ws/src/my_cell"
BEHIND = 0.35  # m: the arm's base behind the tutorial's task frame
CORNERS = 24
MM = 1000


def _stl(triangles) -> bytes:
    """Binary STL; normals are left to the reader, as many programs leave them."""
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(MM * x for corner in triangle for x in corner), 0) for triangle in triangles)
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + body


def _prism(outline, low, high):
    """A convex outline in x and y, between two heights (m)."""
    triangles = []
    for i, (x, y) in enumerate(outline):
        u, v = outline[(i + 1) % len(outline)]
        triangles += [((x, y, low), (u, v, low), (u, v, high)), ((x, y, low), (u, v, high), (x, y, high))]
        if 0 < i < len(outline) - 1:
            a = outline[0]
            triangles += [((*a, high), (x, y, high), (u, v, high)), ((*a, low), (u, v, low), (x, y, low))]
    return triangles


def _mesh_of(solid: str) -> bytes:
    size = {name: [float(x) for x in value.split()] for name, value in re.findall(r'(\w+)="([^"]*)"', solid)}
    if "size" in size:
        x, y, z = (side / 2 for side in size["size"])
        return _stl(_prism([(-x, -y), (x, -y), (x, y), (-x, y)], -z, z))
    radius = size["radius"][0]
    half = size.get("length", [2 * radius])[0] / 2  # a round wrist is milled as a drum
    circle = [(radius * math.cos(a), radius * math.sin(a)) for a in (2 * math.pi * i / CORNERS for i in range(CORNERS))]
    return _stl(_prism(circle, -half, half))


def write_arm(person: Person) -> str:
    """The tutorial's arm, each of its solids a mesh. :return: its URDF's name."""
    urdf = (SOURCE / "docs/tutorial/my_arm/robot.urdf").read_text()
    home = person.machine.home() / PACKAGE
    (home / "meshes").mkdir(parents=True)
    count = 0

    def mesh(found) -> str:
        nonlocal count
        count += 1
        (home / "meshes" / f"part_{count}.stl").write_bytes(_mesh_of(found[1]))
        return f'<geometry><mesh filename="package://my_cell/meshes/part_{count}.stl" scale="0.001 0.001 0.001"/></geometry>'

    urdf = re.sub(r"<geometry>(<(?:box|cylinder|sphere)[^>]*/>)</geometry>", mesh, urdf).replace('name="my_arm"', 'name="mill_arm"')
    person.write(f"{PACKAGE}/urdf/arm.urdf", urdf)
    person.write(f"{PACKAGE}/package.xml", '<package format="3"><name>my_cell</name><version>1.0.0</version></package>\n')
    return f"{PACKAGE}/urdf/arm.urdf"


def _pose(position, orientation) -> str:
    x, y, z = position
    qx, qy, qz, qw = orientation
    return f"{{position: {{x: {x}, y: {y}, z: {z}}}, orientation: {{x: {qx}, y: {qy}, z: {qz}, w: {qw}}}}}"


def scene(problem: dict) -> str:
    """A problem's scene as moveit_msgs/PlanningScene, around the arm's base."""
    objects = []
    solids = [(box, f"{{type: 1, dimensions: {box['size']}}}") for box in problem["scene"]["boxes"]]
    solids += [(c, f"{{type: 3, dimensions: [{c['length']}, {c['radius']}]}}") for c in problem["scene"]["cylinders"]]
    for solid, primitive in solids:
        x, y, z, *turn = solid["pose"]
        objects.append(f"  - header: {{frame_id: base}}\n    id: {solid['name'].replace(' ', '_')}\n"
                       f"    pose: {_pose((x + BEHIND, y, z), turn)}\n    primitives: [{primitive}]\n"
                       f"    primitive_poses: [{_pose((0, 0, 0), (0, 0, 0, 1))}]\n    operation: 0\n")
    return "world:\n  collision_objects:\n" + "".join(objects)


def request(start: "list[float]", goal: "list[float]") -> str:
    """moveit_msgs/MotionPlanRequest: from a configuration to a pose of the palm (x y z qx qy qz qw, of the task frame)."""
    x, y, z, *turn = goal
    names = [f"joint_{i + 1}" for i in range(len(start))]
    qx, qy, qz, qw = turn
    return (f"group_name: arm\nstart_state:\n  joint_state:\n    name: {names}\n    position: {start}\n"
            f"goal_constraints:\n- position_constraints:\n  - header: {{frame_id: base}}\n    link_name: palm\n    constraint_region:\n"
            f"      primitives: [{{type: 2, dimensions: [0.001]}}]\n"
            f"      primitive_poses: [{_pose((x + BEHIND, y, z), (0, 0, 0, 1))}]\n    weight: 1.0\n"
            f"  orientation_constraints:\n  - header: {{frame_id: base}}\n    link_name: palm\n"
            f"    orientation: {{x: {qx}, y: {qy}, z: {qz}, w: {qw}}}\n"
            f"    absolute_x_axis_tolerance: 0.01\n    absolute_y_axis_tolerance: 0.01\n    absolute_z_axis_tolerance: 0.01\n"
            f"    weight: 1.0\nallowed_planning_time: 5.0\n")
