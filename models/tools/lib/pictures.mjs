// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * A set of pictures of a head (protocol/pictures.md): a face at rest, and for the mouth and each eye a sheet of its poses, with anchors
 * and FAPs. A client without a graphics processor morphs them.
 */
import sharp from 'sharp';
import { pose } from './deform.mjs';
import { nearestVertex } from './mesh.mjs';
import { drawHead, seenAt, shadowsOf } from './portrait.mjs';

const FRAME = { width: 480, height: 624 }; // the aspect ratio of the poster, which it replaces
const BESIDE = 190; // columns on each side, with the rest of the shoulders, for wide places
const SIZE = { width: FRAME.width + 2 * BESIDE, height: FRAME.height + 56 }; // and rows below, for when the head turns
const ANCHORS = ['8.4', '8.3', '8.1', '8.2', '2.1']; // corners, middle of the upper and of the lower lip, chin
const SHADOWS = { 3: 350, 4: -150, 5: -450, 8: -150, 9: -150, 10: -400, 11: -400, 51: -150, 52: -450, 55: -150, 56: -150, 57: -400, 58: -400 };
const LIDS = [0, 0.25, 0.5, 0.75, 1]; // how far they are closed
const [LID_UPPER, LID_LOWER] = [940, 84]; // FAP units of closed lids
const CONTOUR_POINTS = 32;
const INNER = 0.7; // of the outer contour: inside, the picture is opaque
const COLUMNS = 5; // of a sheet
const BASE_QUALITY = 88,
  SHEET_QUALITY = 84;

/**
 * @param {object} head unpacked (deform.mjs) @param {{name: string, faps: object}[]} poses of the mouth
 * @param {(name: string) => void} [tell] called with each drawn picture
 */
export async function makePictures(head, poses, tell = () => {}) {
  const shadows = await shadowsOf(head, SHADOWS);
  const draw = (faps, { x, y, width, height }) => drawHead(head, { ...FRAME, faps, crop: { x: x - BESIDE, y, width, height }, shadows });
  const seen = (points) => seenAt(head, FRAME, points).map(([x, ...rest]) => [x + BESIDE, ...rest]);
  const base = await draw({}, { x: 0, y: 0, ...SIZE });
  const skin = head.parts.find(({ name }) => name === 'skin');
  const vertices = Object.fromEntries([...ANCHORS, '9.15', '3.1', '3.2'].map((point) => [point, nearestVertex(skin, head.fdp[point])]));
  const at = (faps, points) => {
    const posed = pose(head, skin, faps);
    return seen(points.map((point) => [0, 1, 2].map((k) => posed[3 * vertices[point] + k])));
  };
  const [[, , near]] = at({}, ['8.1']);
  const perMm = focal(head) / near;
  const fapu = Object.fromEntries(Object.entries(head.fapu).map(([name, mm]) => [name, round(mm * perMm)]));
  const regions = [await mouthRegion(), await eyeRegion('eye_l', '3.1', [19, 21]), await eyeRegion('eye_r', '3.2', [20, 22])];
  const [pivot] = seen([[head.fdp['7.1'][0], head.fdp['7.1'][1], 0]]);
  return {
    format: 'faccia-pictures', version: 1,
    name: head.name, title: head.title, licence: head.licence, credits: head.credits,
    ...SIZE, frame: FRAME, fapu,
    pivot: pivot.slice(0, 2).map(round),
    reach: round(-head.fdp['7.1'][2] * perMm),
    base: await packed(base, BASE_QUALITY, 90),
    regions,
  };

  async function mouthRegion() {
    const [right, left, , , chin] = at({}, ANCHORS).map(([x, y]) => ({ x, y }));
    const [[, nose]] = at({}, ['9.15']);
    const half = (left.x - right.x);
    const middle = (left.x + right.x) / 2;
    const box = boxed(middle - half, nose - 0.9 * fapu.MNS, middle + half, chin.y + 1.15 * fapu.MNS);
    const pictures = [];
    for (const { name, faps } of poses) {
      pictures.push({ name, faps, anchors: at(faps, ANCHORS).map(([x, y]) => [round(x - box.x), round(y - box.y)]), drawn: await draw(faps, box) });
      tell(name);
    }
    return region('mouth', box, pictures);
  }

  async function eyeRegion(name, lid, [upper, lower]) {
    const [[x, y]] = at({}, [lid]);
    const box = boxed(x - 0.36 * fapu.ES, y - 0.28 * fapu.ES, x + 0.36 * fapu.ES, y + 0.32 * fapu.ES);
    const pictures = [];
    for (const shut of LIDS) {
      const faps = shut ? { [upper]: Math.round(shut * LID_UPPER), [lower]: Math.round(shut * LID_LOWER) } : {};
      pictures.push({ name: `closed ${shut}`, faps, drawn: await draw(faps, box) });
      tell(`${name} ${shut}`);
    }
    return region(name, box, pictures);
  }
}

async function region(name, box, pictures) {
  const outer = contour(box, pictures.map(({ drawn }) => drawn.data));
  const centre = [box.width / 2, box.height / 2];
  const inner = outer.map((point) => point.map((x, k) => round(centre[k] + INNER * (x - centre[k]))));
  return {
    name, ...box,
    mask: { inner, outer },
    columns: COLUMNS,
    sheet: await packed(sheetOf(pictures.map(({ drawn }) => drawn), box), SHEET_QUALITY),
    pictures: pictures.map(({ drawn, ...rest }) => rest),
  };
}

/** A rounded rectangle in the box, clipped to the face. */
function contour({ width, height }, pictures) {
  const solid = (x, y) => pictures.every((data) => data[4 * (Math.round(y) * width + Math.round(x)) + 3] === 255);
  const [cx, cy] = [(width - 1) / 2, (height - 1) / 2];
  return Array.from({ length: CONTOUR_POINTS }, (_, i) => {
    const angle = (2 * Math.PI * i) / CONTOUR_POINTS;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const far = (Math.abs(c) ** 4 + Math.abs(s) ** 4) ** -0.25;
    let reach = 0;
    while (reach < 0.98 && solid(cx + cx * c * far * (reach + 0.02), cy + cy * s * far * (reach + 0.02))) reach += 0.02;
    return [round(cx + cx * c * far * reach), round(cy + cy * s * far * reach)];
  });
}

function sheetOf(pictures, { width, height }) {
  const rows = Math.ceil(pictures.length / COLUMNS);
  const sheet = { width: width * COLUMNS, height: height * rows, data: new Uint8ClampedArray(4 * width * COLUMNS * height * rows) };
  pictures.forEach(({ data }, i) => {
    const [left, top] = [(i % COLUMNS) * width, Math.floor(i / COLUMNS) * height];
    for (let y = 0; y < height; y++) sheet.data.set(data.subarray(4 * y * width, 4 * (y + 1) * width), 4 * ((top + y) * sheet.width + left));
  });
  for (let i = 3; i < sheet.data.length; i += 4) sheet.data[i] = 255; // the mask lies on the face
  return sheet;
}

/** @param {number} [alphaQuality] where the picture has an outline */
async function packed({ data, width, height }, quality, alphaQuality) {
  const image = sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } });
  const bytes = await (alphaQuality ? image : image.removeAlpha())
    .webp({ quality, alphaQuality: alphaQuality ?? 100, effort: 6, smartSubsample: true })
    .toBuffer();
  return { type: 'image/webp', data: bytes.toString('base64') };
}

function boxed(left, top, right, bottom) {
  const [x, y] = [Math.floor(left), Math.floor(top)];
  return { x, y, width: Math.ceil(right) - x, height: Math.ceil(bottom) - y };
}

const focal = ({ view: { fov } }) => FRAME.height / 2 / Math.tan((fov * Math.PI) / 360);
const round = (x) => Math.round(x * 100) / 100;
