// SPDX-License-Identifier: GPL-3.0-or-later
// Checks bills of materials (CycloneDX) by their schema and for consistency.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import Ajv from 'ajv';

const folder = path.resolve(import.meta.dirname, '../node_modules/@cyclonedx/cyclonedx-library/res/schema');
const load = (name) => JSON.parse(fs.readFileSync(path.join(folder, name), 'utf8'));
const ajv = new Ajv({ strict: false, validateFormats: false });
for (const name of ['spdx.SNAPSHOT.schema.json', 'jsf-0.82.SNAPSHOT.schema.json']) ajv.addSchema({ ...load(name), $id: `http://cyclonedx.org/schema/${name}` });
const valid = ajv.compile(load('bom-1.5.SNAPSHOT.schema.json'));

/** Checks that every reference resolves to exactly one component, and that all components are connected to the subject. */
export function checkBill(bom) {
  assert.ok(valid(bom), ajv.errorsText(valid.errors));
  assert.deepEqual([bom.bomFormat, bom.specVersion, bom.version], ['CycloneDX', '1.5', 1]);
  const own = bom.metadata.component['bom-ref'];
  const refs = [own, ...bom.components.map((one) => one['bom-ref'])];
  assert.equal(new Set(refs).size, refs.length);
  const next = new Map(bom.dependencies.map(({ ref, dependsOn = [] }) => [ref, dependsOn]));
  assert.equal(next.size, bom.dependencies.length);
  const reached = new Set([own]);
  for (const ref of reached)
    for (const one of next.get(ref) ?? []) {
      assert.ok(refs.includes(one), one);
      reached.add(one);
    }
  assert.deepEqual(refs.filter((ref) => !reached.has(ref)), []);
}
