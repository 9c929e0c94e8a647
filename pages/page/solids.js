// What the layers of a figure are made of, for WebGL. Lengths in metres, but for solids and arms, which come in millimetres.
"use strict";
const kinshipSolids = (() => {
  const {color} = kinshipPage;
  const ball = new THREE.SphereBufferGeometry(1, 20, 14);
  const rod = new THREE.CylinderBufferGeometry(1, 1, 1, 20, 1, true);

  /// The geometry of a solid in its place.
  function geometryOf(object) {
    const [x, y, z, qx, qy, qz, qw] = object.pose;
    const pose = new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(qx, qy, qz, qw),
                                             new THREE.Vector3(1, 1, 1));
    const mm = (n) => n / 1000;
    let solid;
    if (object.box) solid = new THREE.BoxBufferGeometry(...object.box.map(mm));
    else if (object.cylinder)
      solid = new THREE.CylinderBufferGeometry(mm(object.cylinder[0]), mm(object.cylinder[0]), mm(object.cylinder[1]), 28)
                .rotateX(Math.PI / 2);
    else solid = new THREE.SphereBufferGeometry(mm(object.sphere), 20, 14);
    return solid.applyMatrix(pose);
  }

  const edgesOf = (object) => new THREE.EdgesGeometry(geometryOf(object), 30);

  /// Faces that let through what is behind them, unless they are to be solid; edges that clouds do not bury.
  function addObjects(group, layer) {
    const hue = new THREE.Color(color(layer.color));
    const opacity = layer.opacity || 0.22;
    for (const object of layer.objects) {
      const isFloor = object.box && Math.max(...object.box) > 1000 && Math.min(...object.box) < 100;
      const faces = new THREE.Mesh(geometryOf(object), new THREE.MeshLambertMaterial(
        {color: hue, transparent: opacity < 1, opacity: isFloor ? opacity / 3 : opacity, depthWrite: opacity >= 1, side: THREE.DoubleSide,
         polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
      const edges = new THREE.LineSegments(edgesOf(object), new THREE.LineBasicMaterial(
        {color: hue, transparent: true, opacity: opacity < 1 ? 0.85 : 0.4}));
      faces.renderOrder = opacity < 1 ? 20 : 0;
      edges.renderOrder = 21;
      group.add(faces, edges);
    }
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
  function addArm(group, bones, hue, opacity, order) {
    const material = new THREE.MeshPhongMaterial({color: hue, transparent: opacity < 1, opacity, shininess: 18, specular: 0x222222});
    const depth = new THREE.MeshBasicMaterial({colorWrite: false, transparent: true}); // sorted with the others by renderOrder
    const add = (geometry, place) => {
      for (const [look, drawn] of opacity < 1 ? [[depth, order], [material, order + 0.5]] : [[material, 0]]) {
        const mesh = new THREE.Mesh(geometry, look);
        place(mesh);
        mesh.renderOrder = drawn;
        group.add(mesh);
      }
    };
    for (const [ax, ay, az, bx, by, bz, r] of bones) {
      const from = new THREE.Vector3(ax, ay, az).divideScalar(1000);
      const to = new THREE.Vector3(bx, by, bz).divideScalar(1000);
      const radius = r / 1000;
      for (const end of [from, to])
        add(ball, (mesh) => {
          mesh.position.copy(end);
          mesh.scale.setScalar(radius);
        });
      const length = from.distanceTo(to);
      if (length < 1e-4) continue;
      add(rod, (mesh) => {
        mesh.position.copy(from).lerp(to, 0.5);
        mesh.scale.set(radius, length, radius);
        mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), to.clone().sub(from).divideScalar(length));
      });
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
    if (layer.lines) addLines(group, layer);
    if (layer.points) addPoints(group, layer);
    const hue = new THREE.Color(color(layer.color));
    (layer.arms || []).forEach((arm, i) => addArm(group, arm.bones, hue, arm.opacity || 1, 1 + (index + i) % 7));
    for (const way of layer.ways || []) addArm(group, bonesOfWay(way), hue, 1, 0);
    return group;
  }

  /// Gives back what a group holds of the graphics card; balls and rods are shared.
  function dispose(group) {
    for (const drawn of group.children) {
      if (drawn.geometry !== ball && drawn.geometry !== rod) drawn.geometry.dispose();
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
    for (const object of layer.objects || []) each(geometryOf(object).attributes.position.array, 0);
    for (const lines of layer.lines || []) each(lines.positions, 0);
    for (const points of layer.points || []) each(points.positions, (points.size || 0.02) / 2);
    for (const way of layer.ways || []) each(way.positions, (way.width || 0.008) / 2);
    for (const arm of layer.arms || [])
      for (const bone of arm.bones) each(bone.slice(0, 6).map((n) => n / 1000), bone[6] / 1000);
    return balls;
  }

  return {groupOf, dispose, ballsOf, edgesOf, bonesOfWay};
})();
