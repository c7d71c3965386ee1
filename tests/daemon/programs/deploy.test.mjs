// SPDX-License-Identifier: GPL-3.0-or-later
// Checks server/packaging for clusters: the daemon exports each metric that an alert or the dashboard uses, and the containers of the
// Kubernetes manifests start with their arguments and answer their probes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { parseYaml } from '@redocly/openapi-core';
import { Daemon, eventually, root } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { Worker } from '../../lib/worker.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-deploy-'));
const read = (name) => fs.readFileSync(path.join(root, 'server/packaging', name), 'utf8');
const manifests = read('kubernetes.yaml').split('\n---\n').map((text) => parseYaml(text));
const named = (kind, name) => manifests.find((one) => one.kind === kind && one.metadata.name === name);
const container = (name) => named('Deployment', name).spec.template.spec.containers[0];

let redis, daemon;
before(async () => {
  redis = await Redis.start();
  fs.writeFileSync(path.join(folder, 'tokens'), 'a secret of thirty-two bytes, or more\n', { mode: 0o600 });
  const { args, env } = container('facciad');
  const values = { FACCIA_CLUSTER: redis.url, FACCIA_SECRET_FILE: path.join(folder, 'tokens') };
  assert.deepEqual(env.map(({ name }) => name).sort(), Object.keys(values).sort());
  daemon = await Daemon.start(['--host', '*', '--remote', ...args], values); // like the image's entry point
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0);
  redis.stop();
  fs.rmSync(folder, { recursive: true });
});

/** Returns a daemon's time series: metric names with their labels and label values. */
async function series() {
  const plain = await Daemon.start(['--cluster', redis.url]); // without tokens, which /metrics would require
  const report = await (await plain.get('/metrics')).text();
  await plain.stop();
  return report.split('\n').filter((line) => line && !line.startsWith('#')).map((line) => {
    const [, name, labels = ''] = line.match(/^([a-z_]+)(?:\{(.*)\})? /);
    return { name, labels: Object.fromEntries([...labels.matchAll(/([a-z]+)="([^"]*)"/g)].map(([, label, value]) => [label, value])) };
  });
}

test('alerts and dashboard use existing metrics', async () => {
  const known = await series();
  const asked = [
    ...parseYaml(read('alerts.yaml')).groups.flatMap(({ rules }) => rules.map(({ alert, expr }) => [alert, expr])),
    ...JSON.parse(read('grafana.json')).panels.flatMap(({ title, targets }) => targets.map(({ expr }) => [title, expr])),
  ];
  assert.ok(asked.length > 20);
  for (const [who, expression] of asked) {
    const metrics = [...expression.matchAll(/(faccia_[a-z_]+)(?:\{(.*?)\})?/g)];
    assert.ok(metrics.length, `${who} asks for nothing of ours`);
    for (const [, name, matchers = ''] of metrics) {
      const all = known.filter((one) => one.name === name);
      assert.ok(all.length, `${who}: no ${name}`);
      for (const [, label, how, wanted] of matchers.matchAll(/([a-z]+)(=~|=)"([^"]*)"/g))
        for (const value of how === '=~' ? wanted.split('|') : [wanted])
          assert.ok(all.some(({ labels }) => labels[label] === value), `${who}: no ${name}{${label}="${value}"}`);
    }
    for (const [, labels] of expression.matchAll(/by \(([^)]*)\)/g))
      for (const label of labels.split(', ').filter((one) => !['instance', 'job'].includes(one)))
        assert.ok(metrics.some(([, name]) => known.some((one) => one.name === name && label in one.labels)), `${who}: nothing has ${label}`);
  }
});

test('the daemon of the manifest starts, answers its probes, and has only the rights it needs', async () => {
  const { startupProbe, livenessProbe, readinessProbe, ports } = container('facciad');
  for (const { httpGet } of [startupProbe, livenessProbe, readinessProbe]) {
    assert.equal(httpGet.port, ports[0].name);
    assert.equal((await daemon.get(httpGet.path)).status, 200);
  }
  await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up', 'the cluster');
  assert.equal((await daemon.get('/metrics')).status, 401); // tokens are required
  for (const name of ['facciad', 'faccia-worker']) {
    const { securityContext, volumeMounts } = container(name);
    const pod = named('Deployment', name).spec.template.spec;
    assert.deepEqual([securityContext.allowPrivilegeEscalation, securityContext.readOnlyRootFilesystem, securityContext.capabilities.drop, pod.securityContext.runAsNonRoot],
      [false, true, ['ALL'], true]);
    assert.ok(volumeMounts.every((mount) => pod.volumes.some((volume) => volume.name === mount.name)));
    assert.ok(pod.terminationGracePeriodSeconds > Number(container(name).args[container(name).args.indexOf('--stop-seconds') + 1]));
  }
});

test('the worker of the manifest speaks for it', async () => {
  const { command, args, env } = container('faccia-worker');
  assert.deepEqual([command, env.map(({ name }) => name)], [['faccia-worker'], ['FACCIA_CLUSTER']]);
  const worker = await Worker.start(['--cluster', redis.url, ...args]);
  assert.match(worker.log, /ready: /);
  assert.equal((await worker.stop()).code, 0);
});

test('related objects have the same name', () => {
  for (const { kind, metadata, spec } of manifests) {
    if (kind === 'Deployment') assert.deepEqual(spec.selector.matchLabels, spec.template.metadata.labels, metadata.name);
    if (kind === 'HorizontalPodAutoscaler') assert.ok(named('Deployment', spec.scaleTargetRef.name), metadata.name);
    if (kind === 'PodDisruptionBudget' || kind === 'Service') assert.ok(named('Deployment', (spec.selector.matchLabels ?? spec.selector).app), metadata.name);
  }
  const [{ host, http }] = named('Ingress', 'facciad').spec.rules;
  assert.equal(http.paths[0].backend.service.name, named('Service', 'facciad').metadata.name);
  const { args } = container('facciad');
  assert.deepEqual([args[args.indexOf('--host-name') + 1], args[args.indexOf('--origin') + 1]], [host, `https://${host}`]);
});
