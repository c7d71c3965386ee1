// SPDX-License-Identifier: MIT
// Loads unpackers: each is a separate script with its WebAssembly, fetched by the first avatar that needs it, from the
// location given by the element, since this script may be a copy under another name. Nothing runs in workers made of text,
// and nothing else is fetched, so the content security policy needs only `'wasm-unsafe-eval'` for it.
import { BufferAttribute, BufferGeometry } from 'three';
import { AvatarProblem } from './problem.mjs';

const SCRIPTS = {
  draco: async (address) => (await import(/* webpackIgnore: true */ /* @vite-ignore */ address)).openDraco(),
  basis: async (address) => (await import(/* webpackIgnore: true */ /* @vite-ignore */ address)).openBasis(),
  meshopt: async () => {
    const { MeshoptDecoder } = await import('meshoptimizer/decoder'); // not before: it is WebAssembly
    await MeshoptDecoder.ready;
    return MeshoptDecoder;
  },
};
const NAMES = { draco: 'Draco', basis: 'KTX2', meshopt: 'meshopt' };

const open = new Map();
let places = {};

/** @param {{draco: string, basis: string}} addresses of the scripts that unpack */
export function setUnpackers(addresses) {
  places = addresses;
}

/** @param {'draco'|'basis'|'meshopt'} name @throws {AvatarProblem} where it may not run here */
export function unpacker(name) {
  if (!open.has(name)) {
    const coming = SCRIPTS[name](places[name]).catch((error) => {
      open.delete(name);
      const why = `the page's policy has to allow 'wasm-unsafe-eval' (${error.message})`;
      throw new AvatarProblem('unsupported', `it is packed with ${NAMES[name]}: ${why}`);
    });
    open.set(name, coming);
  }
  return open.get(name);
}

/**
 * Draco as GLTFLoader asks for it. @param {Awaited<ReturnType<typeof unpacker>>} draco
 * @param {object} json the GLB's: no primitive may have more than the largest of its accessors
 */
export function dracoOf(draco, json) {
  const points = (json.accessors ?? []).reduce((most, { count }) => Math.max(most, count), 0);
  return {
    preload() {},
    decodeDracoFile(buffer, done, ids, types, _space, failed) {
      try {
        const wanted = Object.fromEntries(Object.entries(ids).map(([name, id]) => [name, { id, type: types[name] }]));
        const { index, attributes } = draco.decode(new Uint8Array(buffer), wanted, { points, corners: points });
        const geometry = new BufferGeometry();
        geometry.setIndex(new BufferAttribute(index, 1));
        for (const [name, { array, width }] of Object.entries(attributes))
          geometry.setAttribute(name, new BufferAttribute(array, width));
        done(geometry);
      } catch (error) {
        failed(error);
      }
    },
  };
}
