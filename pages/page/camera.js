// A camera that fits what is drawn, whatever the window's shape.
"use strict";
const kinshipCamera = (() => {
  const kFieldOfView = 30; // degrees, vertical
  const kMargin = 0.94;    // of the picture that what is drawn may take

  /// Puts the camera where every ball of `balls` ([x, y, z, radius]) is in the picture and the picture as full as can be,
  /// looking along -direction. \return  the point to turn around.
  /// A ball is left of the right edge of a picture with tangent t if x + r / cos <= X + t (Z - z), in the camera's own
  /// axes; so the nearest camera follows from the largest and least x + t z and x - t z, and likewise in height.
  function fit(camera, balls, direction, aspect) {
    const back = new THREE.Vector3(...direction).normalize();
    const right = new THREE.Vector3(-back.y, back.x, 0);
    if (right.lengthSq() < 1e-9) right.set(1, 0, 0);
    right.normalize();
    const up = new THREE.Vector3().crossVectors(back, right);
    const tallness = Math.tan(kFieldOfView / 2 * Math.PI / 180) * kMargin;
    const sides = [[right, tallness * aspect], [up, tallness]].map(([axis, tangent]) => {
      let most = -Infinity, least = Infinity;
      for (const [x, y, z, radius] of balls) {
        const across = axis.x * x + axis.y * y + axis.z * z;
        const depth = tangent * (back.x * x + back.y * y + back.z * z);
        const reach = radius * Math.sqrt(1 + tangent * tangent);
        most = Math.max(most, across + depth + reach);
        least = Math.min(least, across - depth - reach);
      }
      return {middle: (most + least) / 2, distance: (most - least) / (2 * tangent)};
    });
    let nearest = -Infinity, farthest = Infinity;
    for (const [x, y, z] of balls) {
      const depth = back.x * x + back.y * y + back.z * z;
      nearest = Math.max(nearest, depth);
      farthest = Math.min(farthest, depth);
    }
    const distance = Math.max(sides[0].distance, sides[1].distance, nearest + 0.05);
    const place = (depth) => right.clone().multiplyScalar(sides[0].middle).addScaledVector(up, sides[1].middle)
                                  .addScaledVector(back, depth);
    const target = place((nearest + farthest) / 2);
    const size = Math.max(nearest - farthest, 0.1);
    camera.fov = kFieldOfView;
    camera.aspect = aspect;
    camera.near = Math.max(0.005, (distance - nearest) / 4);
    camera.far = distance - farthest + 10 * size;
    camera.up.set(0, 0, 1);
    camera.position.copy(place(distance));
    camera.lookAt(target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    return target;
  }

  /// Turns the camera around `target`, by angles in rad, and comes nearer by a factor.
  function move(camera, target, {around = 0, over = 0, nearer = 1}) {
    const offset = camera.position.clone().sub(target);
    const distance = offset.length() / nearer;
    const azimuth = Math.atan2(offset.y, offset.x) + around;
    const height = Math.max(-1.5, Math.min(1.5, Math.asin(offset.z / offset.length()) + over));
    camera.position.set(Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height))
          .multiplyScalar(distance).add(target);
    camera.lookAt(target);
    camera.updateMatrixWorld();
  }

  /// The line that is drawn nearest to a point of the picture.
  /// \param lines   [{positions: pairs of points}, ...]
  /// \param at      [x, y] in the picture, from its upper left corner
  /// \param size    [width, height] of the picture
  /// \param within  so near, in the unit of both
  /// \return {line, segment: its number}, or null
  function nearestLine(camera, lines, [x, y], [width, height], within) {
    camera.updateMatrixWorld();
    const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    const place = (p, i) => { // null behind the camera
      const w = m[3] * p[i] + m[7] * p[i + 1] + m[11] * p[i + 2] + m[15];
      return w <= 0 ? null : [((m[0] * p[i] + m[4] * p[i + 1] + m[8] * p[i + 2] + m[12]) / w + 1) / 2 * width,
                              (1 - (m[1] * p[i] + m[5] * p[i + 1] + m[9] * p[i + 2] + m[13]) / w) / 2 * height];
    };
    let found = null, least = within;
    for (const line of lines)
      for (let i = 0; i + 5 < line.positions.length; i += 6) {
        const from = place(line.positions, i), to = place(line.positions, i + 3);
        if (!from || !to) continue;
        const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        const part = Math.max(0, Math.min(1, ((x - from[0]) * dx + (y - from[1]) * dy) / Math.max(1e-9, dx * dx + dy * dy)));
        const distance = Math.hypot(from[0] + part * dx - x, from[1] + part * dy - y);
        if (distance > least) continue;
        least = distance;
        found = {line, segment: i / 6};
      }
    return found;
  }

  return {fit, move, nearestLine};
})();
