// What the layers of a figure are made of, for WebGL. Lengths in metres, but for solids and arms, which come in millimetres.
"use strict";
const kinshipSolids = (() => {
  const {color} = kinshipPage;
  const ball = new THREE.SphereBufferGeometry(1, 20, 14);
  const rod = new THREE.CylinderBufferGeometry(1, 1, 1, 20, 1, true);
  const thin = [new THREE.SphereBufferGeometry(1, 8, 6), new THREE.CylinderBufferGeometry(1, 1, 1, 8, 1, true)];

  /// [x, y, z, qx, qy, qz, qw] in m, or a matrix already.
  function matrixOf(pose) {
    if (pose.isMatrix4) return pose;
    const [x, y, z, qx, qy, qz, qw] = pose;
    return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(qx, qy, qz, qw), new THREE.Vector3(1, 1, 1));
  }

  /// Half a circle at each end of a line, turned around it.
  function capsuleGeometry(radius, length) {
    const outline = [];
    for (let i = 0; i <= 16; ++i) {
      const angle = -Math.PI / 2 + Math.PI * i / 16;
      outline.push(new THREE.Vector2(Math.max(1e-6, radius * Math.cos(angle)), radius * Math.sin(angle) + (i < 8 ? -1 : 1) * length / 2));
    }
    return new THREE.LatheBufferGeometry(outline, 24);
  }

  function newGeometry(object) {
    const mm = (n) => n / 1000;
    if (object.box) return new THREE.BoxBufferGeometry(...object.box.map(mm));
    if (object.cylinder) {
      const [radius, length] = object.cylinder.map(mm);
      return new THREE.CylinderBufferGeometry(radius, radius, length, 28).rotateX(Math.PI / 2);
    }
    if (object.capsule) return capsuleGeometry(...object.capsule.map(mm)).rotateX(Math.PI / 2);
    return new THREE.SphereBufferGeometry(mm(object.sphere), 20, 14);
  }

  /// Faces and edges of a solid in its own frame, made once for each size.
  const shapes = new Map();
  function shapeOf(object) {
    const key = JSON.stringify([object.box, object.cylinder, object.capsule, object.sphere]);
    if (!shapes.has(key)) {
      const faces = newGeometry(object);
      const edges = new THREE.EdgesGeometry(faces, 30);
      shapes.set(key, {faces, edges});
    }
    return shapes.get(key);
  }

  /// One geometry of many, each moved by a matrix: a single drawing call, which costs more than its triangles.
  function merged(parts) {
    const positions = [], normals = [], indices = [];
    const at = new THREE.Vector3();
    for (const [geometry, matrix] of parts) {
      const {position, normal} = geometry.attributes;
      const first = positions.length / 3;
      const turn = new THREE.Matrix3().getNormalMatrix(matrix);
      for (let i = 0; i < position.count; ++i) {
        at.fromBufferAttribute(position, i).applyMatrix4(matrix);
        positions.push(at.x, at.y, at.z);
        if (!normal) continue;
        at.fromBufferAttribute(normal, i).applyMatrix3(turn).normalize();
        normals.push(at.x, at.y, at.z);
      }
      if (geometry.index) for (const index of geometry.index.array) indices.push(first + index);
    }
    const all = new THREE.BufferGeometry();
    all.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    if (normals.length) all.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
    if (indices.length) all.setIndex(indices);
    return all;
  }

  const inPlace = (name, objects) => merged(objects.map((object) => [shapeOf(object)[name], matrixOf(object.pose)]));
  /// Corners of a solid in its place; pairs of points of its edges.
  const pointsOf = (object) => inPlace("faces", [object]).attributes.position.array;
  const edgesOf = (object) => inPlace("edges", [object]).attributes.position.array;

  /// Faces that let through what is behind them, unless they are to be solid; edges that clouds do not bury.
  function addObjects(group, layer) {
    const hue = new THREE.Color(color(layer.color));
    const opacity = layer.opacity || 0.22;
    const isFloor = (object) => object.box && Math.max(...object.box) > 1000 && Math.min(...object.box) < 100;
    for (const [objects, part] of [[layer.objects.filter((object) => !isFloor(object)), 1], [layer.objects.filter(isFloor), 1 / 3]]) {
      if (!objects.length) continue;
      const faces = new THREE.Mesh(inPlace("faces", objects), new THREE.MeshLambertMaterial(
        {color: hue, transparent: opacity < 1, opacity: opacity < 1 ? opacity * part : 1, depthWrite: opacity >= 1, side: THREE.DoubleSide,
         polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
      const edges = new THREE.LineSegments(inPlace("edges", objects), new THREE.LineBasicMaterial(
        {color: hue, transparent: true, opacity: opacity < 1 ? 0.85 : 0.4}));
      faces.renderOrder = opacity < 1 ? 20 : 0;
      edges.renderOrder = 21;
      group.add(faces, edges);
    }
  }

  /// A mesh from its canonical bytes in base64: uint32 vertices, uint32 triangles, float32 x y z, uint32 corners.
  function meshGeometry(text) {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    const [vertices, triangles] = new Uint32Array(bytes.buffer, 0, 2);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytes.buffer, 8, 3 * vertices), 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes.buffer, 8 + 12 * vertices, 3 * triangles), 1));
    geometry.computeBoundingSphere();
    geometry.userData.isKept = true; // others place it too
    return geometry;
  }

  /// Meshes in their places, in their own colours if they have some.
  function addMeshes(group, layer) {
    for (const {geometry, pose, rgba} of layer.meshes) {
      const hue = rgba && rgba.length ? new THREE.Color(rgba[0], rgba[1], rgba[2]) : new THREE.Color(color(layer.color));
      const opacity = (layer.opacity || 1) * (rgba && rgba.length ? rgba[3] : 1);
      const mesh = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({color: hue, flatShading: true, shininess: 18, specular: 0x222222,
        transparent: opacity < 1, opacity, depthWrite: opacity >= 1, side: THREE.DoubleSide}));
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrixOf(pose));
      mesh.renderOrder = opacity < 1 ? 20 : 0;
      group.add(mesh);
    }
  }

  /// The edges of a mesh as pairs of points in their places, for a drawing without WebGL.
  function meshEdgesOf({geometry, pose}) {
    const edges = [];
    const {position} = geometry.attributes;
    const corner = (i) => new THREE.Vector3().fromBufferAttribute(position, i).applyMatrix4(matrixOf(pose)).toArray();
    const {array} = geometry.index;
    for (let i = 0; i + 2 < array.length; i += 3)
      for (const [a, b] of [[0, 1], [1, 2], [2, 0]])
        if (array[i + a] < array[i + b]) edges.push(...corner(array[i + a]), ...corner(array[i + b]));
    return edges;
  }

  /// A round dot, so that points are not squares.
  let dot = null;
  function dotTexture() {
    if (dot) return dot;
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 64;
    const pen = canvas.getContext("2d");
    pen.fillStyle = "#fff";
    pen.beginPath();
    pen.arc(32, 32, 29, 0, 2 * Math.PI);
    pen.fill();
    dot = new THREE.CanvasTexture(canvas);
    return dot;
  }

  function addPoints(group, layer) {
    for (const {positions, size = 0.02, opacity = 0.6} of layer.points) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
      const cloud = new THREE.Points(geometry, new THREE.PointsMaterial(
        {color: color(layer.color), size, map: dotTexture(), transparent: true, opacity, alphaTest: 0.05, depthWrite: false}));
      cloud.renderOrder = 9; // after the arms: what is before them is seen
      group.add(cloud);
    }
  }

  function addLines(group, layer) {
    for (const {positions, opacity = 0.5} of layer.lines) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
      const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial(
        {color: color(layer.color), transparent: true, opacity, depthWrite: false}));
      lines.renderOrder = 8;
      group.add(lines);
    }
  }

  /// Capsules. A translucent arm is drawn twice: depth first, then colour where nothing of the arm is nearer, so that it does
  /// not show its own inside.
  function addArm(group, bones, hue, opacity, order, [ends, rods] = [ball, rod]) {
    const material = new THREE.MeshPhongMaterial({color: hue, transparent: opacity < 1, opacity, shininess: 18, specular: 0x222222});
    const depth = new THREE.MeshBasicMaterial({colorWrite: false, transparent: true}); // sorted with the others by renderOrder
    const parts = [];
    const none = new THREE.Quaternion();
    for (const [ax, ay, az, bx, by, bz, r] of bones) {
      const from = new THREE.Vector3(ax, ay, az).divideScalar(1000);
      const to = new THREE.Vector3(bx, by, bz).divideScalar(1000);
      const radius = r / 1000;
      for (const end of [from, to]) parts.push([ends, new THREE.Matrix4().compose(end, none, new THREE.Vector3(radius, radius, radius))]);
      const length = from.distanceTo(to);
      if (length < 1e-4) continue;
      const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), to.clone().sub(from).divideScalar(length));
      parts.push([rods, new THREE.Matrix4().compose(from.clone().lerp(to, 0.5), turn, new THREE.Vector3(radius, length, radius))]);
    }
    const geometry = merged(parts);
    for (const [look, drawn] of opacity < 1 ? [[depth, order], [material, order + 0.5]] : [[material, 0]]) {
      const mesh = new THREE.Mesh(geometry, look);
      mesh.renderOrder = drawn;
      group.add(mesh);
    }
  }

  /// A thick line through points: capsules from each to the next.
  const bonesOfWay = ({positions, width = 0.008}) => {
    const mm = positions.map((n) => 1000 * n);
    const bones = [];
    for (let i = 3; i + 2 < mm.length; i += 3) bones.push([...mm.slice(i - 3, i + 3), 500 * width]);
    return bones;
  };

  /// \param index  of the layer in its figure.
  function groupOf(layer, index) {
    const group = new THREE.Group();
    if (layer.objects) addObjects(group, layer);
    if (layer.meshes) addMeshes(group, layer);
    if (layer.lines) addLines(group, layer);
    if (layer.points) addPoints(group, layer);
    const hue = new THREE.Color(color(layer.color));
    (layer.arms || []).forEach((arm, i) => addArm(group, arm.bones, hue, arm.opacity || 1, 1 + (index + i) % 7));
    for (const way of layer.ways || []) addArm(group, bonesOfWay(way), way.color ? new THREE.Color(color(way.color)) : hue, 1, 0, thin);
    return group;
  }

  /// Gives back what a group holds of the graphics card.
  function dispose(group) {
    for (const drawn of group.children) {
      if (!drawn.geometry.userData.isKept) drawn.geometry.dispose();
      drawn.material.dispose();
    }
  }

  /// What a layer takes of the room, as balls [x, y, z, radius] in metres.
  function ballsOf(layer) {
    const balls = [];
    const each = (positions, radius) => {
      for (let i = 0; i + 2 < positions.length; i += 3)
        balls.push([positions[i], positions[i + 1], positions[i + 2], radius]);
    };
    for (const object of layer.objects || []) each(pointsOf(object), 0);
    for (const {geometry, pose} of layer.meshes || [])
      each(geometry.boundingSphere.center.clone().applyMatrix4(matrixOf(pose)).toArray(), geometry.boundingSphere.radius);
    for (const lines of layer.lines || []) each(lines.positions, 0);
    for (const points of layer.points || []) each(points.positions, (points.size || 0.02) / 2);
    for (const way of layer.ways || []) each(way.positions, (way.width || 0.008) / 2);
    for (const arm of layer.arms || [])
      for (const bone of arm.bones) each(bone.slice(0, 6).map((n) => n / 1000), bone[6] / 1000);
    return balls;
  }

  return {groupOf, dispose, ballsOf, edgesOf, meshGeometry, meshEdgesOf, bonesOfWay, matrixOf};
})();
