// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Renders a mesh for the face detector: from a distance, lit from above the camera, with darkened hollows. Each pixel records the visible
 * surface point.
 */
const SKIN = [205, 160, 138];
const GREY = 200;
const IRIS = 0.5; // of the eyeball's radius
const HOLLOW = [6, 14]; // pixels around
const HOLLOW_DEEP = 0.05; // of the picture's width: depth at which a hollow is dark

/** Returns the rotation to a view's axes: x to the right, y up, z to the camera. @param {number} yaw in degrees */
export function yawed(yaw) {
  const [c, s] = [Math.cos((yaw * Math.PI) / 180), Math.sin((yaw * Math.PI) / 180)];
  return ([x, y, z]) => [x * c + z * s, y, z * c - x * s];
}

/**
 * @param {{position: ArrayLike<number>, index: ArrayLike<number>, color: number[]|null, ball: {centre: number[], radius: number}|null}[]} meshes
 *   color: 0 to 1, or null if unknown
 * @param {{middle: number[], width: number, yaw: number}} camera target and visible width
 * @param {number} size pixels, both ways
 * @returns {{picture: object, at: (column: number, row: number) => {mesh: number, triangle: number, point: number[]}|null}}
 */
export function viewOf(meshes, { middle, width, yaw }, size) {
  const turn = yawed(yaw);
  const scale = size / width;
  const depth = new Float32Array(size * size).fill(-Infinity);
  const seen = new Int32Array(size * size).fill(-1);
  const shade = new Float32Array(size * size);
  const first = [];
  let total = 0;
  const flats = meshes.map((mesh) => {
    first.push(total);
    total += mesh.index.length / 3;
    const flat = new Float64Array(mesh.position.length);
    for (let i = 0; i < flat.length; i += 3) {
      const [x, y, z] = turn([mesh.position[i] - middle[0], mesh.position[i + 1] - middle[1], mesh.position[i + 2] - middle[2]]);
      flat[i] = size / 2 + x * scale;
      flat[i + 1] = size / 2 - y * scale;
      flat[i + 2] = z * scale;
    }
    return flat;
  });
  meshes.forEach((mesh, m) => {
    const p = flats[m];
    const normals = normalsOf(p, mesh.index);
    for (let t = 0; t < mesh.index.length; t += 3) {
      const [a, b, c] = [mesh.index[t] * 3, mesh.index[t + 1] * 3, mesh.index[t + 2] * 3];
      const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
      if (!area) continue;
      const low = Math.max(0, Math.ceil(Math.min(p[a + 1], p[b + 1], p[c + 1])));
      const high = Math.min(size - 1, Math.floor(Math.max(p[a + 1], p[b + 1], p[c + 1])));
      const left = Math.max(0, Math.ceil(Math.min(p[a], p[b], p[c])));
      const right = Math.min(size - 1, Math.floor(Math.max(p[a], p[b], p[c])));
      for (let v = low; v <= high; v++)
        for (let u = left; u <= right; u++) {
          const wb = ((u - p[a]) * (p[c + 1] - p[a + 1]) - (v - p[a + 1]) * (p[c] - p[a])) / area;
          const wc = ((p[b] - p[a]) * (v - p[a + 1]) - (p[b + 1] - p[a + 1]) * (u - p[a])) / area;
          const wa = 1 - wb - wc;
          if (wa < 0 || wb < 0 || wc < 0) continue;
          const z = wa * p[a + 2] + wb * p[b + 2] + wc * p[c + 2];
          const at = v * size + u;
          if (z <= depth[at]) continue;
          depth[at] = z;
          seen[at] = first[m] + t / 3;
          const nx = wa * normals[a] + wb * normals[b] + wc * normals[c];
          const ny = wa * normals[a + 1] + wb * normals[b + 1] + wc * normals[c + 1];
          const nz = wa * normals[a + 2] + wb * normals[b + 2] + wc * normals[c + 2];
          const facing = (nz < 0 ? -1 : 1) / (Math.sqrt(nx * nx + ny * ny + nz * nz) || 1); // for either winding
          shade[at] = 0.38 + 0.62 * Math.max(0, facing * (0.95 * nz - 0.3 * ny));
        }
    }
  });
  const meshOf = (triangle) => {
    let m = first.length - 1;
    while (first[m] > triangle) m--;
    return m;
  };
  const at = (u, v) => {
    const [column, row] = [Math.round(u), Math.round(v)];
    if (column < 0 || row < 0 || column >= size || row >= size) return null;
    const triangle = seen[row * size + column];
    if (triangle < 0) return null;
    const m = meshOf(triangle);
    const place = [(u - size / 2) / scale, -(v - size / 2) / scale, depth[row * size + column] / scale];
    const point = yawed(-yaw)(place).map((x, k) => x + middle[k]);
    return { mesh: m, triangle: triangle - first[m], point };
  };
  const data = new Uint8ClampedArray(4 * size * size);
  const hollow = hollows(depth, size);
  for (let i = 0; i < seen.length; i++) {
    let color = [GREY, GREY + 4, GREY + 8];
    if (seen[i] >= 0) {
      const mesh = meshes[meshOf(seen[i])];
      color = mesh.color ? mesh.color.map((x) => 255 * Math.sqrt(x)) : SKIN;
      if (mesh.ball) color = onBall(mesh.ball, at(i % size, Math.floor(i / size)).point);
      const light = shade[i] * hollow[i];
      color = color.map((x, k) => x * light ** (k ? 1.1 : 1)); // shaded skin is redder
    }
    data.set([...color, 255], 4 * i);
  }
  const place = (u, v) => [middle[0] + (u - size / 2) / scale, middle[1] - (v - size / 2) / scale]; // of a view from the front
  return { picture: { data, width: size, height: size }, at, place, depth, scale };
}

/** Colour of an eye that looks straight ahead. */
function onBall({ centre, radius }, point) {
  const off = Math.hypot(point[0] - centre[0], point[1] - centre[1]);
  if (point[2] < centre[2]) return SKIN;
  return off < 0.4 * IRIS * radius ? [20, 16, 14] : off < IRIS * radius ? [84, 60, 42] : [232, 226, 222];
}

/** Like in mesh.mjs, but for any winding, weighted by area. */
function normalsOf(p, index) {
  const out = new Float64Array(p.length);
  const same = new Map(); // coincident vertices share a normal
  const own = Int32Array.from({ length: p.length / 3 }, (_, v) => {
    const key = `${p[3 * v].toFixed(2)},${p[3 * v + 1].toFixed(2)},${p[3 * v + 2].toFixed(2)}`;
    if (!same.has(key)) same.set(key, v);
    return same.get(key);
  });
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [index[t] * 3, index[t + 1] * 3, index[t + 2] * 3];
    const [u, v] = [b, c].map((q) => [p[q] - p[a], p[q + 1] - p[a + 1], p[q + 2] - p[a + 2]]);
    const n = [v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]]; // rows run down
    for (const corner of [index[t], index[t + 1], index[t + 2]]) for (let k = 0; k < 3; k++) out[3 * own[corner] + k] += n[k];
  }
  own.forEach((v, i) => v !== i && out.set(out.subarray(3 * v, 3 * v + 3), 3 * i));
  return out;
}

/** Darkens places deeper than their surroundings: sockets, nostrils, the line between the lips. */
function hollows(depth, size) {
  const out = new Float32Array(depth.length).fill(1);
  const around = HOLLOW.flatMap((far) => Array.from({ length: 8 }, (_, i) => [Math.round(far * Math.cos((i * Math.PI) / 4)), Math.round(far * Math.sin((i * Math.PI) / 4))]));
  for (let v = 0; v < size; v++)
    for (let u = 0; u < size; u++) {
      const here = depth[v * size + u];
      if (here === -Infinity) continue;
      let dark = 0;
      for (const [dx, dy] of around) {
        const [x, y] = [u + dx, v + dy];
        if (x < 0 || y < 0 || x >= size || y >= size) continue;
        const above = depth[y * size + x] - here;
        if (above > 0) dark += Math.min(1, above / (HOLLOW_DEEP * size)) / around.length;
      }
      out[v * size + u] = 1 - 0.75 * Math.min(1, 2.5 * dark);
    }
  return out;
}
