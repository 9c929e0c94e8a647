// A robot in a configuration: forward kinematics as robots/kinematics has it, and the solids of its links in their places.
"use strict";
const kinshipChain = (() => {
  const {matrixOf} = kinshipSolids;
  const times = (...matrices) => matrices.reduce((product, next) => product.clone().multiply(next));

  /// The motion of a joint, in its own frame.
  function motion(joint, value) {
    const axis = new THREE.Vector3(...joint.axis);
    return joint.type === "prismatic" ? new THREE.Matrix4().makeTranslation(...axis.multiplyScalar(value).toArray())
      : new THREE.Matrix4().makeRotationAxis(axis, value);
  }

  /// Poses in the base link. \param robot  see drawn_robot.hpp \param q  a number for each joint
  /// \return {links: a matrix for each, transfer: that of the transfer frame}
  function posesOf(robot, q) {
    const moved = [];
    robot.joints.forEach((joint, i) => {
      const here = times(matrixOf(joint.T_previous_joint), motion(joint, q[i]));
      moved.push(i ? times(moved[i - 1], here) : here);
    });
    const last = moved[moved.length - 1];
    for (const mimic of robot.mimics) {
      const here = times(matrixOf(mimic.joint.T_previous_joint), motion(mimic.joint, mimic.multiplier * q[mimic.source] + mimic.offset));
      moved.push(mimic.before < 0 ? here : times(moved[mimic.before], here));
    }
    return {
      links: robot.links.map((link) => (link.joint < 0 ? matrixOf(link.T_joint_link) : times(moved[link.joint], matrixOf(link.T_joint_link)))),
      transfer: times(last, matrixOf(robot.T_last_tip), matrixOf(robot.T_tip_transfer))};
  }

  /// The robot's solids, and those that it holds, for a layer of kinshipView.
  /// \param T_task_base  matrix, or a pose
  /// \param held         solids in the transfer frame
  /// \return {links, held: solids with name and place, transfer: the transfer frame in the task frame}
  function solidsOf(robot, q, T_task_base, held = []) {
    const base = matrixOf(T_task_base);
    const poses = posesOf(robot, q);
    const transfer = times(base, poses.transfer);
    return {
      links: robot.links.flatMap((link, i) =>
        link.solids.map((solid) => ({...solid, pose: times(base, poses.links[i], matrixOf(solid.pose))}))),
      held: held.map((solid) => ({...solid, pose: times(transfer, matrixOf(solid.pose))})),
      transfer};
  }

  /// The robot's meshes of a role ("visual", "collision"), for a layer of kinshipView.
  /// \param geometries  by content
  function meshesOf(robot, geometries, role, q) {
    const {links} = posesOf(robot, q);
    return robot.meshes.filter((mesh) => mesh.role === role || mesh.role === "both").map((mesh) =>
      ({geometry: geometries[mesh.content], pose: times(links[mesh.link], matrixOf(mesh.pose)), rgba: role === "visual" ? mesh.rgba : []}));
  }

  const originOf = (matrix) => new THREE.Vector3().setFromMatrixPosition(matrix).toArray();

  /// The axes of a frame as ways of a layer: x, y and z in three colours.
  const axesOf = (matrix, length = 0.12) => ["x", "y", "z"].map((name, i) => {
    const end = new THREE.Vector3().setFromMatrixColumn(matrix, i).multiplyScalar(length).add(new THREE.Vector3(...originOf(matrix)));
    return {positions: [...originOf(matrix), ...end.toArray()], width: length / 12, color: "axis-" + name};
  });

  /// [x, y, z, qx, qy, qz, qw]
  function poseOf(matrix) {
    const [position, quaternion, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
    matrix.decompose(position, quaternion, scale);
    return [...position.toArray(), ...quaternion.toArray()];
  }

  return {posesOf, solidsOf, meshesOf, originOf, axesOf, poseOf};
})();
