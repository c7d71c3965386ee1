// SPDX-License-Identifier: GPL-3.0-or-later
// Starting and stopping the daemon: options, refusals, signals.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

const facciad = (args) => {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/daemon/facciad'), args, { timeout: 20000 });
  return { status, stdout: String(stdout), stderr: String(stderr) };
};

test('prints help and version', () => {
  const { status, stdout } = facciad(['--help']);
  assert.equal(status, 0);
  assert.match(stdout, /--remote/);
  assert.match(facciad(['--version']).stdout, /^facciad \d/);
});

const refusals = [
  [['--host', '0.0.0.0', '--port', '0'], 1, /--remote/],
  [['--host', '0.0.0.0', '--port', '0', '--remote'], 1, /--secret-file/],
  [['--host', 'nowhere.invalid', '--port', '0'], 1, /loopback/],
  [['--port', '70000'], 2, /--port: '70000' is not a whole number from 0 to 65535/],
  [['--port', 'x'], 2, /--port/],
  [['--workers', '0'], 2, /--workers/],
  [['--lang', 'xx', '--port', '0'], 1, /unknown language 'xx'/],
  [['--models', '/nowhere', '--port', '0'], 1, /\/nowhere/],
  [['--plugins', '/nowhere', '--port', '0'], 1, /\/nowhere/],
  [['--media', '/nowhere'], 2, /--media: '\/nowhere' is not a folder/],
  [['--nonsense'], 2, /facciad --help/],
  [['extra'], 2, /unexpected 'extra'/],
];
for (const [args, code, message] of refusals)
  test(`facciad ${args.join(' ')}: exits with ${code}`, () => {
    const { status, stderr } = facciad(args);
    assert.match(stderr, message);
    assert.equal(status, code);
  });

test('reports a port in use', async () => {
  const daemon = await Daemon.start();
  const { status, stderr } = facciad(['--port', String(daemon.port)]);
  assert.equal(status, 1);
  assert.match(stderr, new RegExp(`cannot listen on 127.0.0.1 port ${daemon.port}`));
  assert.equal((await daemon.stop()).code, 0);
});

test('--remote admits other machines', async () => {
  const daemon = await Daemon.start(['--host', '0.0.0.0', '--remote', '--secret-file', file('secret', 'x'.repeat(32))]);
  assert.equal((await daemon.get('/healthz')).status, 200);
  assert.equal((await daemon.stop()).code, 0);
});

test('SIGTERM during speech ends it and leaves no process behind', async () => {
  const daemon = await Daemon.start();
  const stream = await daemon.stream();
  stream.send({ type: 'speak', lang: 'it', text: 'Una frase lunga, che non finisce mai. '.repeat(50) });
  await stream.until(() => stream.chunks.length > 0);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  await stream.closed;
  if (os.platform() === 'linux') {
    const left = spawnSync('pgrep', ['-P', String(daemon.process.pid)]);
    assert.equal(String(left.stdout), '');
  }
});

test('refuses connections beyond the limit, and keeps those within it', async () => {
  const daemon = await Daemon.start(['--max-connections', '5']);
  const streams = [];
  for (let i = 0; i < 5; i++) streams.push(await daemon.stream());
  await assert.rejects(daemon.stream());
  streams[0].send({ type: 'ping', id: 1 });
  await streams[0].wait({ type: 'pong', id: 1 });
  await streams[1].close();
  const late = await eventually(() => daemon.stream().catch(() => null), 'a connection, once the daemon knows that another one has gone');
  await late.wait({ type: 'hello' });
  assert.equal((await daemon.stop()).code, 0);
});

test('a thousand short connections leak nothing', async () => {
  const daemon = await Daemon.start();
  for (let i = 0; i < 50; i++) {
    const streams = await Promise.all(Array.from({ length: 20 }, () => daemon.stream()));
    streams.forEach((stream, k) => (k % 2 ? stream.socket.terminate() : stream.close()));
  }
  await daemon.left(3);
  assert.equal((await daemon.stop()).code, 0);
});

test('disconnects a listener that stops reading, which delays no one', async () => {
  const daemon = await Daemon.start();
  const [stuck, other] = await Promise.all([daemon.stream(), daemon.stream()]);
  stuck.socket._socket.pause();
  stuck.send({ type: 'speak', lang: 'it', text: 'Una frase lunga, che non finisce mai. '.repeat(100) });
  for (let i = 0; i < 2000; i++) stuck.send({ type: 'ping', id: 'x'.repeat(2000) });
  other.send({ type: 'speak', lang: 'it', text: 'Io sento bene.' });
  assert.equal((await other.wait({ type: 'end' })).reason, 'done');
  await daemon.logged(/listening/);
  await daemon.left(2); // the stalled connection was closed
  stuck.socket.terminate();
  await other.close();
  assert.equal((await daemon.stop()).code, 0);
});

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-operate-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name, content) => {
  const where = path.join(folder, name);
  fs.writeFileSync(where, typeof content === 'string' ? content : JSON.stringify(content));
  return where;
};

test('settings: options override the environment, which overrides the file', () => {
  const config = file('a.json', { limits: { text_bytes: 1000, queue: 5, connections: 7 }, access: { origins: ['https://a.example'] } });
  const { status, stdout } = spawnSync(path.join(build, 'server/daemon/facciad'), ['--print-config', '--config', config, '--max-connections', '9'], {
    encoding: 'utf8',
    env: { ...process.env, FACCIA_MAX_QUEUE: '6', FACCIA_MAX_CONNECTIONS: '8' },
  });
  assert.equal(status, 0);
  const { limits, access, listen } = JSON.parse(stdout);
  assert.deepEqual([limits.text_bytes, limits.queue, limits.connections], [1000, 6, 9]);
  assert.deepEqual(access.origins, ['https://a.example']);
  assert.equal(listen.port, 8080);
  // the printed configuration gives the same configuration
  const again = facciad(['--print-config', '--config', file('b.json', stdout)]);
  assert.deepEqual(JSON.parse(again.stdout), JSON.parse(stdout));
});

test('the help lists every option with its member, and the printed settings every member', () => {
  const help = facciad(['--help']).stdout;
  const printed = JSON.parse(facciad(['--print-config']).stdout);
  const members = [...help.matchAll(/\[(\w+)\.(\w+)\]$/gm)].map(([, group, name]) => `${group}.${name}`);
  assert.deepEqual(
    members.sort(),
    Object.entries(printed).flatMap(([group, all]) => Object.keys(all).map((name) => `${group}.${name}`)).sort(),
  );
});

const wrongFiles = [
  ['{"limits": {"text_bytes": "many"}}', /limits\.text_bytes: must be a number from 1 to 104857600/],
  ['{"limits": {"text_bytes": 1.5}}', /limits\.text_bytes: '1\.5' is not a whole number/],
  ['{"limits": {"text_byte": 1}}', /limits\.text_byte: unknown setting; near: limits\.text_bytes/],
  ['{"limits": 3}', /limits: must be an object/],
  ['{"listen": {"remote": 1}}', /listen\.remote: must be true or false/],
  ['{"access": {"origins": "x"}}', /access\.origins: must be a list/],
  ['{"access": {"origins": [1]}}', /access\.origins: item 0/],
  ['{"log": {"format": "xml"}}', /log\.format: 'xml' is not one of text\|json/],
  ['{"voices": {"plugins": {"espeak": 1}}}', /voices\.plugins\.espeak: must be an object/],
  ['{"limits":\n {"queue": }}', /:2:\d+: /],
  ['[]', /must be an object/],
];
for (const [content, message] of wrongFiles)
  test(`rejects settings ${JSON.stringify(content)}`, () => {
    const { status, stderr } = facciad(['--port', '0', '--config', file('wrong.json', content)]);
    assert.equal(status, 2);
    assert.match(stderr, message);
  });

test('reports a missing file and a wrong variable', () => {
  assert.match(facciad(['--config', '/nowhere.json']).stderr, /\/nowhere\.json/);
  const { status, stderr } = spawnSync(path.join(build, 'server/daemon/facciad'), [], { encoding: 'utf8', env: { ...process.env, FACCIA_PORT: 'x' } });
  assert.equal(status, 2);
  assert.match(stderr, /FACCIA_PORT: 'x'/);
});

test('SIGHUP applies new limits, and keeps the old ones if they are wrong', async () => {
  const config = file('live.json', { limits: { text_bytes: 10 } });
  const daemon = await Daemon.start(['--config', config]);
  const stream = await daemon.stream();
  const says = async (id) => {
    stream.send({ type: 'speak', id, lang: 'it', text: 'Buongiorno a tutti.' });
    return (await stream.wait({ type: 'end', id })).reason;
  };
  assert.equal(await says('a'), 'failed');
  file('live.json', { limits: { text_bytes: 100 } });
  daemon.process.kill('SIGHUP');
  await daemon.logged(/settings reloaded/);
  assert.equal(await says('b'), 'done');
  file('live.json', '{');
  daemon.process.kill('SIGHUP');
  await daemon.logged(/keeping the current settings/);
  assert.equal(await says('c'), 'done');
  file('live.json', { limits: { text_bytes: 100 }, voices: { workers: 3 } });
  daemon.process.kill('SIGHUP');
  await daemon.logged(/take effect after a restart/);
  assert.equal((await daemon.stop()).code, 0);
});

test('SIGTERM lets speech finish, refuses new requests, and closes streams properly', async () => {
  const daemon = await Daemon.start(['--stop-seconds', '60']);
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'last', lang: 'it', text: 'Questa frase si sente fino alla fine.' });
  await stream.until(() => stream.chunks.length > 0);
  daemon.process.kill('SIGTERM');
  await daemon.logged(/stopping/);
  stream.send({ type: 'speak', id: 'late', lang: 'it', text: 'Troppo tardi.' });
  await stream.wait({ type: 'error', id: 'late', code: 'stopping' });
  await stream.wait({ type: 'end', id: 'last', reason: 'done' });
  assert.deepEqual(await stream.closed, { code: 1001, reason: 'stopping' });
  assert.deepEqual(await daemon.exited, { code: 0, signal: null });
});

test('SIGTERM cuts long speech, and a second one does not wait', async () => {
  const long = { type: 'speak', lang: 'it', text: 'Una frase lunga, che non finisce mai. '.repeat(50) };
  for (const [seconds, times] of [['1', 1], ['3600', 2]]) {
    const daemon = await Daemon.start(['--stop-seconds', seconds]);
    const stream = await daemon.stream();
    stream.send(long);
    await stream.until(() => stream.chunks.length > 0);
    for (let i = 0; i < times; i++) {
      daemon.process.kill('SIGTERM');
      await daemon.logged(/stopping/);
    }
    assert.deepEqual(await daemon.exited, { code: 0, signal: null });
  }
});

test('writes log lines as JSON', async () => {
  const daemon = await Daemon.start(['--log', 'json']).catch((error) => error);
  assert.ok(daemon instanceof Daemon, String(daemon));
  assert.equal((await daemon.stop()).code, 0);
  const lines = daemon.log.trim().split('\n').map((line) => JSON.parse(line));
  assert.ok(lines.some((line) => line.level === 'info' && /^ready: /.test(line.message)));
  assert.ok(lines.every((line) => /^\d{4}-.*Z$/.test(line.time) && line.pid > 0));
});

test('as a systemd service: inherits the socket, and reports its state', async () => {
  // like systemd: listens, passes the socket as descriptor 3, and receives notifications
  const script = `
import os, socket, subprocess, sys, urllib.request, signal
heard = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
path = sys.argv[1] + '/notify'
heard.bind(path)
heard.settimeout(20)
server = socket.socket()
server.bind(('127.0.0.1', 0))
server.listen()
def hand_over():
    os.dup2(server.fileno(), 3)
    os.set_inheritable(3, True)
    os.environ['LISTEN_PID'] = str(os.getpid())
env = dict(os.environ, LISTEN_FDS='1', NOTIFY_SOCKET=path)
child = subprocess.Popen(['sh', '-c', 'LISTEN_PID=$$ exec "$0"', sys.argv[2]], env=env, pass_fds=[3], preexec_fn=hand_over)
def wait(word):
    while True:
        text = heard.recv(4096).decode()
        if word in text:
            return
wait('READY=1')
print(urllib.request.urlopen('http://127.0.0.1:%d/healthz' % server.getsockname()[1]).status)
child.send_signal(signal.SIGHUP)
wait('RELOADING=1')
wait('READY=1')
child.terminate()
wait('STOPPING=1')
print(child.wait())
`;
  const { stdout, stderr } = spawnSync('python3', ['-c', script, folder, path.join(build, 'server/daemon/facciad')], { encoding: 'utf8', timeout: 60000 });
  assert.equal(stdout, '200\n0\n', stderr);
});
