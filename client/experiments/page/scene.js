// Three-dimensional figures: turnable with WebGL, a still drawing without. Lengths in metres.
"use strict";
const kinshipScene = (() => {
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  function hasWebGl() {
    try {
      return Boolean(document.createElement("canvas").getContext("webgl"));
    } catch (error) {
      return false;
    }
  }

  /// Corners of an object's outline: pairs of points.
  function edgesOf(object) {
    const [x, y, z, qx, qy, qz, qw] = object.pose;
    const pose = new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(qx, qy, qz, qw),
                                             new THREE.Vector3(1, 1, 1));
    const mm = (n) => n / 1000;
    let solid;
    if (object.box) solid = new THREE.BoxBufferGeometry(...object.box.map(mm));
    else if (object.cylinder)
      solid = new THREE.CylinderBufferGeometry(mm(object.cylinder[0]), mm(object.cylinder[0]), mm(object.cylinder[1]), 20)
                .rotateX(Math.PI / 2);
    else solid = new THREE.SphereBufferGeometry(mm(object.sphere), 10, 8);
    return {solid: solid.applyMatrix(pose), edges: new THREE.EdgesGeometry(solid, 30)};
  }

  function addObstacles(scene, objects) {
    const hue = new THREE.Color(color("scene"));
    for (const object of objects) {
      const {solid, edges} = edgesOf(object);
      const isTable = object.name === "table";
      scene.add(new THREE.Mesh(solid, new THREE.MeshLambertMaterial(
        {color: hue, transparent: true, opacity: isTable ? 0.16 : 0.2, depthWrite: false})));
      scene.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({color: hue, transparent: true, opacity: 0.75})));
    }
  }

  /// A round dot, so that points are not squares.
  function dot() {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 64;
    const pen = canvas.getContext("2d");
    pen.fillStyle = "#fff";
    pen.beginPath();
    pen.arc(32, 32, 29, 0, 2 * Math.PI);
    pen.fill();
    return new THREE.CanvasTexture(canvas);
  }

  function addPoints(scene, points, texture) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(points.positions, 3));
    const cloud = new THREE.Points(geometry, new THREE.PointsMaterial(
      {color: color(points.color), size: points.size, map: texture, transparent: true, opacity: points.opacity,
       alphaTest: 0.3, depthWrite: false}));
    cloud.renderOrder = 9; // after the arms: what is before them is seen
    scene.add(cloud);
  }

  function addLines(scene, lines) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(lines.positions, 3));
    scene.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial(
      {color: color(lines.color), transparent: true, opacity: lines.opacity})));
  }

  /// Drawn twice: depth first, then color where nothing of the arm is nearer, so that a translucent
  /// arm does not show its own inside.
  function addArm(scene, bones, name, opacity, order) {
    const depth = new THREE.MeshBasicMaterial({colorWrite: false});
    const material = new THREE.MeshLambertMaterial({color: color(name), transparent: true, opacity});
    const add = (mesh) => {
      const shadow = mesh.clone();
      shadow.material = depth;
      depth.transparent = true; // sorted with the others by renderOrder
      shadow.renderOrder = order;
      mesh.renderOrder = order + 0.5;
      scene.add(shadow, mesh);
    };
    for (const [ax, ay, az, bx, by, bz, r] of bones) {
      const from = new THREE.Vector3(ax, ay, az).divideScalar(1000);
      const to = new THREE.Vector3(bx, by, bz).divideScalar(1000);
      for (const end of [from, to]) {
        const ball = new THREE.Mesh(new THREE.SphereBufferGeometry(r / 1000, 18, 12), material);
        ball.position.copy(end);
        add(ball);
      }
      const length = from.distanceTo(to);
      if (length < 1e-4) continue;
      const rod = new THREE.Mesh(new THREE.CylinderBufferGeometry(r / 1000, r / 1000, length, 18, 1, true), material);
      rod.position.copy(from).lerp(to, 0.5);
      rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), to.clone().sub(from).divideScalar(length));
      add(rod);
    }
  }

  function camera(view) {
    const camera = new THREE.PerspectiveCamera(33, 2, 0.05, 30);
    camera.up.set(0, 0, 1);
    camera.position.set(...view.eye);
    camera.lookAt(new THREE.Vector3(...view.target));
    return camera;
  }

  function build(view) {
    const scene = new THREE.Scene();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.85));
    const sun = new THREE.DirectionalLight(0xffffff, 0.5);
    sun.position.set(-2, -3, 4);
    scene.add(sun);
    const texture = dot();
    addObstacles(scene, view.obstacles);
    for (const lines of view.lines) addLines(scene, lines);
    for (const points of view.points) addPoints(scene, points, texture);
    view.arms.forEach((arm, i) => addArm(scene, arm.bones, arm.color, arm.opacity, 1 + i));
    return scene;
  }

  function showTurnable(figure, view) {
    const renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    figure.prepend(renderer.domElement);
    const eye = camera(view);
    const controls = new THREE.OrbitControls(eye, renderer.domElement);
    controls.target.set(...view.target);
    controls.enableZoom = true;
    let scene = build(view);
    const draw = () => {
      renderer.setSize(figure.clientWidth, figure.clientHeight, false);
      eye.aspect = figure.clientWidth / figure.clientHeight;
      eye.updateProjectionMatrix();
      renderer.render(scene, eye);
    };
    controls.addEventListener("change", draw);
    window.addEventListener("resize", draw);
    matchMedia("(prefers-color-scheme: dark)").addListener(() => {
      scene = build(view);
      draw();
    });
    controls.update();
    draw();
  }

  /// Without WebGL: the same from the same place, points, lines and arms as strokes.
  function showStill(figure, view) {
    const canvas = document.createElement("canvas");
    figure.prepend(canvas);
    const width = canvas.width = 2 * figure.clientWidth;
    const height = canvas.height = 2 * figure.clientHeight;
    const pen = canvas.getContext("2d");
    const eye = camera(view);
    eye.aspect = width / height;
    eye.updateProjectionMatrix();
    eye.updateMatrixWorld();
    const project = (x, y, z) => {
      const p = new THREE.Vector3(x, y, z).project(eye);
      return [(p.x + 1) / 2 * width, (1 - p.y) / 2 * height];
    };
    const strokes = (positions, name, opacity, thickness) => {
      pen.strokeStyle = color(name);
      pen.globalAlpha = opacity;
      pen.lineWidth = thickness;
      pen.beginPath();
      for (let i = 0; i + 5 < positions.length; i += 6) {
        pen.moveTo(...project(positions[i], positions[i + 1], positions[i + 2]));
        pen.lineTo(...project(positions[i + 3], positions[i + 4], positions[i + 5]));
      }
      pen.stroke();
    };
    for (const object of view.obstacles) strokes(edgesOf(object).edges.attributes.position.array, "scene", 0.8, 2);
    for (const lines of view.lines) strokes(lines.positions, lines.color, lines.opacity, 2);
    for (const points of view.points) {
      pen.fillStyle = color(points.color);
      pen.globalAlpha = points.opacity;
      for (let i = 0; i < points.positions.length; i += 3) {
        const [x, y] = project(points.positions[i], points.positions[i + 1], points.positions[i + 2]);
        pen.fillRect(x - 2, y - 2, 4, 4);
      }
    }
    pen.lineCap = "round";
    const scale = height / (2 * Math.tan(eye.fov * Math.PI / 360) * eye.position.distanceTo(new THREE.Vector3(...view.target)));
    for (const arm of view.arms)
      for (const bone of arm.bones)
        strokes(bone.slice(0, 6).map((n) => n / 1000), arm.color, 0.35, Math.max(3, 2 * scale * bone[6] / 1000));
  }

  function show(figure, view) {
    const turnable = hasWebGl();
    const legend = document.createElement("div");
    legend.className = "legend";
    for (const [name, text] of view.legend) {
      const entry = document.createElement("span");
      const mark = document.createElement("i");
      mark.style.background = "var(--" + name + ")";
      entry.append(mark, text);
      legend.append(entry);
    }
    const hint = document.createElement("div");
    hint.className = "hint";
    hint.textContent = turnable ? "drag to turn, scroll to zoom" : "a still projection: this browser has no WebGL";
    figure.append(legend, hint);
    (turnable ? showTurnable : showStill)(figure, view);
  }

  return {show, color};
})();
