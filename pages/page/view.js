// Figures of the station: turnable with WebGL, a still drawing without.
"use strict";
const kinshipView = (() => {
  const {color, make, onColors, onSize} = kinshipPage;
  const {groupOf, dispose, ballsOf, edgesOf, meshEdgesOf, bonesOfWay} = kinshipSolids;
  const views = new WeakMap(); // by their figures

  function hasWebGl() {
    try {
      return Boolean(document.createElement("canvas").getContext("webgl"));
    } catch (error) {
      return false;
    }
  }

  /// Draws the layers with WebGL. What follows is asked by `show`: set(index, layer), draw(), fit(balls).
  function turnable(stage, canvas, direction) {
    const renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    const scene = new THREE.Scene();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.78));
    const sun = new THREE.DirectionalLight(0xffffff, 0.42);
    sun.position.set(-2, -3, 4);
    scene.add(sun);
    const camera = new THREE.PerspectiveCamera();
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableKeys = false; // ours are those of the canvas only
    controls.enableZoom = false; // until the figure has the focus
    controls.screenSpacePanning = true;
    const groups = [];
    let replaced = []; // kept until the next are drawn, so that their programs stay compiled
    let frame = null;
    const render = () => {
      cancelAnimationFrame(frame);
      frame = null;
      renderer.render(scene, camera);
      replaced.forEach(dispose);
      replaced = [];
    };
    const draw = () => { // once for all that changes before the next picture
      if (frame === null) frame = requestAnimationFrame(render);
    };
    controls.addEventListener("change", draw);
    controls.addEventListener("start", () => stage.dataset.turned = "yes");
    return {
      controls, camera, draw,
      set(index, layer) {
        if (groups[index]) {
          scene.remove(groups[index]);
          replaced.push(groups[index]);
        }
        groups[index] = groupOf(layer, index);
        groups[index].visible = layer.shown;
        scene.add(groups[index]);
      },
      close() {
        cancelAnimationFrame(frame);
        controls.dispose();
        groups.forEach(dispose);
        renderer.dispose();
        renderer.forceContextLoss(); // a browser keeps but a few
      },
      fit(balls, anew) {
        renderer.setSize(stage.clientWidth, stage.clientHeight, false);
        const from = anew || !stage.dataset.turned ? direction : camera.position.clone().sub(controls.target).toArray();
        controls.target.copy(kinshipCamera.fit(camera, balls, from, stage.clientWidth / stage.clientHeight));
        controls.update();
        render();
      },
      grow(index, lines, points) {
        for (const drawn of groups[index].children) {
          if (drawn.isLineSegments) drawn.geometry.setDrawRange(0, 2 * lines);
          if (drawn.isPoints) drawn.geometry.setDrawRange(0, points);
        }
        draw();
      },
      follow(other) {
        other.controls.addEventListener("change", () => {
          if (camera.position.equals(other.camera.position) && controls.target.equals(other.controls.target)) return;
          camera.position.copy(other.camera.position);
          controls.target.copy(other.controls.target);
          camera.near = other.camera.near;
          camera.far = other.camera.far;
          camera.updateProjectionMatrix();
          stage.dataset.turned = "yes";
          controls.update();
          draw();
        });
      },
      move(how) {
        stage.dataset.turned = "yes";
        kinshipCamera.move(camera, controls.target, how);
        controls.update();
        draw();
      }};
  }

  /// Without WebGL: the same from the same place, points, lines and arms as strokes.
  function still(stage, canvas, direction) {
    const camera = new THREE.PerspectiveCamera();
    const pen = canvas.getContext("2d");
    const layers = [];
    let target = new THREE.Vector3();
    const project = (x, y, z) => {
      const p = new THREE.Vector3(x, y, z).project(camera);
      return [(p.x + 1) / 2 * canvas.width, (1 - p.y) / 2 * canvas.height];
    };
    const stroke = (positions, opacity, thickness) => {
      pen.globalAlpha = opacity;
      pen.lineWidth = thickness;
      pen.beginPath();
      for (let i = 0; i + 5 < positions.length; i += 6) {
        pen.moveTo(...project(positions[i], positions[i + 1], positions[i + 2]));
        pen.lineTo(...project(positions[i + 3], positions[i + 4], positions[i + 5]));
      }
      pen.stroke();
    };
    const drawLayer = (layer) => {
      const pixels = canvas.height / (2 * Math.tan(camera.fov * Math.PI / 360) * camera.position.distanceTo(target));
      const strokeBones = (bones, opacity) => {
        for (const bone of bones)
          stroke(bone.slice(0, 6).map((n) => n / 1000), opacity, Math.max(2, 2 * pixels * bone[6] / 1000));
      };
      pen.strokeStyle = pen.fillStyle = color(layer.color);
      pen.lineCap = "round";
      for (const arm of layer.arms || []) strokeBones(arm.bones, 0.4 * (arm.opacity || 1));
      for (const lines of layer.lines || []) stroke(lines.positions, lines.opacity || 0.5, 2);
      for (const {positions, size = 0.02, opacity = 0.6} of layer.points || []) {
        pen.globalAlpha = opacity;
        const edge = Math.max(3, pixels * size);
        for (let i = 0; i + 2 < positions.length; i += 3) {
          const [x, y] = project(positions[i], positions[i + 1], positions[i + 2]);
          pen.fillRect(x - edge / 2, y - edge / 2, edge, edge);
        }
      }
      for (const object of layer.objects || []) stroke(edgesOf(object), 0.85, 2);
      for (const mesh of layer.meshes || []) stroke(meshEdgesOf(mesh), 0.35, 1);
      for (const way of layer.ways || []) {
        pen.strokeStyle = color(way.color || layer.color);
        strokeBones(bonesOfWay(way), 1);
      }
    };
    const draw = () => {
      pen.clearRect(0, 0, canvas.width, canvas.height);
      for (const layer of layers)
        if (layer.shown) drawLayer(layer);
    };
    return {
      camera, draw,
      set(index, layer) { layers[index] = layer; },
      grow(index, lines, points) {
        const {lines: [line] = [], points: [cloud] = []} = layers[index].whole || layers[index];
        layers[index] = {...layers[index], whole: {lines: [line], points: [cloud]},
                         lines: line && [{...line, positions: line.positions.slice(0, 6 * lines)}],
                         points: cloud && [{...cloud, positions: cloud.positions.slice(0, 3 * points)}]};
        draw();
      },
      follow() {},
      close() {},
      fit(balls) {
        canvas.width = 2 * stage.clientWidth;
        canvas.height = 2 * stage.clientHeight;
        target = kinshipCamera.fit(camera, balls, direction, canvas.width / canvas.height);
        draw();
      }};
  }

  /// Who scrolls the page scrolls past the figure: wheel, fingers and keys are the figure's while it has the focus, which a
  /// click, a tap or the Tab key gives it. A mouse turns it at once.
  function listen(canvas, drawing, refit) {
    const {controls} = drawing;
    const own = (has) => {
      controls.enableZoom = has;
      canvas.style.touchAction = has ? "none" : "auto";
    };
    own(false);
    canvas.addEventListener("focus", () => own(true));
    canvas.addEventListener("blur", () => own(false));
    canvas.addEventListener("pointerdown", (event) => {
      controls.enabled = event.pointerType !== "touch" || document.activeElement === canvas;
    });
    canvas.addEventListener("click", () => canvas.focus({preventScroll: true}));
    const step = Math.PI / 24;
    const moves = {ArrowLeft: {around: -step}, ArrowRight: {around: step}, ArrowUp: {over: step}, ArrowDown: {over: -step},
                   "+": {nearer: 1.15}, "=": {nearer: 1.15}, "-": {nearer: 1 / 1.15}};
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.key === "Escape") canvas.blur();
      else if (event.key === "0") refit();
      else if (moves[event.key]) drawing.move(moves[event.key]);
      else return;
      event.preventDefault();
    });
  }

  /// Tells the owner of the line at which a reader clicks, without dragging; null beside all of them.
  function listenToPicks(canvas, drawing, layers, onPick) {
    const kNear = 12; // pixels
    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
    canvas.addEventListener("click", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
      const lines = layers.flatMap((layer) => (layer.shown && layer.lines ? layer.lines.filter((line) => line.owners) : []));
      const {left, top, width, height} = canvas.getBoundingClientRect();
      const found = kinshipCamera.nearestLine(drawing.camera, lines, [event.clientX - left, event.clientY - top], [width, height], kNear);
      onPick(found && found.line.owners[found.segment]);
    });
  }

  /// A button for each layer with a text: pressed while the layer is shown.
  function legendOf(layers, toggle) {
    const legend = make("div", {class: "legend", role: "group", "aria-label": "What is shown"});
    layers.forEach((layer, index) => {
      if (layer.text === undefined) return;
      const button = make("button", {type: "button", hidden: !layer.text, "aria-pressed": String(layer.shown), "data-layer": layer.name,
                                     onclick: () => button.setAttribute("aria-pressed", String(toggle(index)))},
                          make("i", {style: `--hue: var(--${layer.color})`}), make("span", {}, layer.text));
      legend.append(button);
    });
    return legend;
  }

  /// Shows layers in a <figure>.
  ///
  /// \param view.label   what a reader hears who does not see it
  /// \param view.from    direction from which one looks at first, [x, y, z]
  /// \param view.layers  each {name, color (of the style, without --), and any of: text (in the legend, which hides and
  ///   shows the layer; "": not now), shown (true), fits (true: the camera sees all of it), objects [{pose, box | cylinder | capsule |
  ///   sphere}] with opacity, meshes [{geometry, pose, rgba}] with opacity, arms [{bones, opacity}], lines [{positions: pairs, opacity, owners: of each pair, to be picked}], ways [{positions: one line, width, color}],
  ///   points [{positions, size, opacity}]}. Solids and bones are those of pages/page/json_text.hpp.
  /// \param view.onPick  called with the owner of a line that is clicked, and with null for a click beside all of them
  /// \return {replace(name, layer): other content, colour or text for a layer; show(name, shown); grow(name, lines, points):
  ///   only so many segments and points of it; follow(other): turns as another figure does; fit(); count(name): drawn solids,
  ///   meshes, arms, ways, segments and points of a layer, and what grow() left of it}; counts(figure, name) is the same from outside.
  ///   Without its figure in the page it gives back what it holds.
  function show(figure, view) {
    const layers = view.layers.map((layer) => ({shown: true, fits: true, ...layer}));
    const isTurnable = hasWebGl();
    const canvas = make("canvas", {role: "img", "aria-label": view.label, tabindex: isTurnable ? "0" : null});
    const stage = make("div", {class: "stage"}, canvas);
    const refit = (anew) => drawing.fit(layers.flatMap((layer) => (layer.fits ? ballsOf(layer) : [])), anew);
    const again = () => refit(true);
    const toggle = (index) => {
      layers[index].shown = !layers[index].shown;
      put(index);
      drawing.draw();
      return layers[index].shown;
    };
    const picks = view.onPick ? " Click a line to pick it." : "";
    const hint = isTurnable
      ? make("div", {class: "hint"},
             make("span", {}, (matchMedia("(pointer: coarse)").matches
               ? "Tap it, then drag to turn and pinch to zoom."
               : "Drag to turn. Click it, then scroll to zoom; or use the arrow keys, + and \u2212.") + picks),
             make("button", {type: "button", onclick: again}, "Reset view"))
      : make("div", {class: "hint"}, "A still projection: this browser has no WebGL." + picks);
    figure.classList.add("view");
    figure.append(legendOf(layers, toggle), stage, hint);
    const drawing = (isTurnable ? turnable : still)(stage, canvas, view.from);
    const grown = new Map();
    const indexOf = (name) => layers.findIndex((layer) => layer.name === name);
    const put = (index) => {
      drawing.set(index, layers[index]);
      const range = grown.get(layers[index].name);
      if (range) drawing.grow(index, ...range);
    };
    const setAll = () => layers.forEach((layer, index) => put(index));
    setAll();
    refit(true);
    if (isTurnable) listen(canvas, drawing, again);
    if (view.onPick) listenToPicks(canvas, drawing, layers, view.onPick);
    onSize(stage, () => (stage.isConnected ? refit(false) : drawing.close()));
    onColors(stage, () => {
      setAll();
      drawing.draw();
    });
    const shown = {
      replace(name, layer) {
        const index = indexOf(name);
        layers[index] = {...layers[index], ...layer};
        drawing.set(index, layers[index]);
        drawing.draw();
        const button = figure.querySelector(`[data-layer="${name}"]`);
        if (!button) return;
        button.firstChild.style.setProperty("--hue", `var(--${layers[index].color})`);
        button.lastChild.textContent = layers[index].text;
        button.hidden = !layers[index].text;
      },
      count(name) {
        const {objects = [], meshes = [], arms = [], ways = [], lines = [], points = []} = layers[indexOf(name)];
        const numbers = (list) => list.reduce((sum, each) => sum + each.positions.length, 0);
        return {objects: objects.length, meshes: meshes.length, arms: arms.length, ways: ways.length, segments: numbers(lines) / 6, points: numbers(points) / 3, grown: grown.get(name)};
      },
      grow(name, lines, points) {
        grown.set(name, [lines, points]);
        drawing.grow(indexOf(name), lines, points);
      },
      follow(other) { drawing.follow(other.drawing); },
      drawing,
      show(name, shown) {
        const index = indexOf(name);
        layers[index].shown = shown;
        put(index);
        drawing.draw();
        const button = figure.querySelector(`[data-layer="${name}"]`);
        if (button) button.setAttribute("aria-pressed", String(shown));
      },
      fit: again};
    views.set(figure, shown);
    return shown;
  }

  return {show, counts: (figure, name) => views.get(figure).count(name)};
})();
