// SPDX-License-Identifier: MIT
// The tools and resources of faccia for the Model Context Protocol.
import { randomUUID } from 'node:crypto';
import { setTimeout as sleep } from 'node:timers/promises';
import { McpServer, ResourceTemplate } from '@modelcontextprotocol/sdk/server/mcp.js';
import { z } from 'zod';
import { DaemonError } from './daemon.mjs';

const WAIT_SECONDS = 600; // most, for a text to be heard
const FILM_SECONDS = 1800; // most, for a film to be made
const FILM_LOOK_MS = 500;
const READ_CHARACTERS = 20000; // most, of a section that is returned

const text = z.string().min(1).max(65536);
const room = z.string().min(1).max(64).optional().describe('The room of the head; leave out for the usual one.');
const choices = z.array(z.string().min(1).max(200)).min(1).max(8);
const mix = z.array(z.object({ name: z.string(), intensity: z.number().min(0).max(1).default(1) })).max(4);
const speaking = {
  lang: z.string().optional().describe('BCP 47 tag of the language, such as it or pt-BR.'),
  voice: z.string().optional().describe('Id of a voice of faccia://voices; by default one that suits the head.'),
  rate: z.number().min(40).max(600).optional().describe('Words per minute.'),
  affect: z.string().optional().describe('Expression during the text, such as joy: a name of faccia://expressions.'),
};

const say = (words, structured) => ({
  content: [{ type: 'text', text: words }],
  ...(structured ? { structuredContent: structured } : {}),
});
const without = (object) => Object.fromEntries(Object.entries(object).filter(([, value]) => value !== undefined));
const heardBy = (listeners) => (listeners ? `${listeners} ${listeners === 1 ? 'listener' : 'listeners'}` : 'nobody: the room is empty');

/** Returns the text of a section's blocks. */
const plain = (blocks) => blocks.filter((block) => block.text && block.kind !== 'note').map((block) => block.text).join('\n\n');

/** @param {import('./daemon.mjs').Daemon} daemon @param {{room: string, version: string}} options room: the usual one */
export function makeServer(daemon, { room: usual, version }) {
  const server = new McpServer({ name: 'faccia', version }, {
    instructions: 'faccia is a talking head on a screen. Use say to have it speak to the people in a room, and ask to get an answer from them.',
  });

  /** Failures of the daemon are answers in plain words, which the model can act on. */
  const tool = (name, about, act) =>
    server.registerTool(name, about, async (args, extra) => {
      try {
        return await act({ room: usual, ...without(args) }, extra);
      } catch (error) {
        if (!(error instanceof DaemonError)) throw error;
        return { ...say(error.message), isError: true };
      }
    });

  /** Waits for messages of a room. seconds: most; begin() and look(message) return the result, or undefined to go on. */
  async function watch(where, seconds, signal, begin, look) {
    const found = new AbortController();
    const ending = AbortSignal.any([signal, found.signal, AbortSignal.timeout(seconds * 1000)]);
    try {
      const messages = await daemon.listen(where, ending);
      const known = await begin();
      if (known !== undefined) return known;
      for await (const message of messages) {
        const result = look(message);
        if (result !== undefined) return result;
      }
    } catch (error) {
      if (signal.aborted || !ending.aborted) throw error;
    } finally {
      found.abort(); // closes the connection
    }
    return null;
  }

  tool('say', {
    title: 'Say',
    description: 'Has the head speak a text, or a passage of the library, to the people in a room. Texts queue.',
    inputSchema: {
      text: text.optional().describe('What to say: plain text, Markdown, or SSML.'),
      passage: z.string().max(128).optional().describe('Id of a passage or section of the library, instead of a text.'),
      room,
      ...speaking,
      mode: z.enum(['queue', 'interrupt', 'replace', 'quiet']).optional().describe('interrupt: before others; replace: drops the others.'),
      wait: z.boolean().optional().describe('Return only when it has been heard.'),
    },
    annotations: { openWorldHint: true },
  }, async ({ room: where, wait, ...speech }, { signal }) => {
    if ((speech.text === undefined) === (speech.passage === undefined)) throw new DaemonError('Give either text or passage.', 'bad-field');
    const message = { type: 'speak', id: randomUUID(), ...speech };
    let listeners = 0;
    const send = async () => {
      ({ listeners = 0 } = await daemon.command(where, message));
      return listeners ? undefined : { reason: 'unheard' }; // it is held for who may come, or not spoken
    };
    if (!wait) {
      await send();
      return say(`Said to ${heardBy(listeners)}.`, { listeners });
    }
    let trouble = null;
    const end = await watch(where, WAIT_SECONDS, signal, send, (event) => {
      if (event.id !== message.id) return undefined;
      if (event.type === 'error') trouble = event;
      return event.type === 'end' ? event : undefined;
    });
    if (trouble) throw new DaemonError(trouble.message, trouble.code);
    if (end?.reason === 'unheard') return say('Nobody listens: the room is empty.', { listeners, heard: false });
    if (!end) throw new DaemonError('It has not been heard to its end in ten minutes.', 'too-long');
    const heard = end.reason === 'done';
    return say(heard ? `Heard by ${heardBy(listeners)}.` : 'It was stopped before its end.', { listeners, heard });
  });

  tool('ask', {
    title: 'Ask',
    description: 'Says a question in a room, shows the answers as buttons, and waits until somebody chooses one.',
    inputSchema: {
      question: text.describe('The question, as it is spoken.'),
      choices: choices.describe('Two to eight short answers.'),
      room,
      ...speaking,
      seconds: z.number().int().min(5).max(WAIT_SECONDS).optional().describe('How long to wait for an answer; 60 by default.'),
    },
  }, async ({ question, choices: offered, room: where, seconds = 60, ...speech }, { signal }) => {
    const id = randomUUID();
    const ask = async () => {
      await daemon.command(where, { type: 'speak', id: randomUUID(), text: question, ...speech });
      await daemon.command(where, { type: 'choices', id, question, choices: offered });
    };
    const chosen = await watch(where, seconds, signal, ask, (event) => (event.type === 'chosen' && event.id === id ? event : undefined));
    if (chosen) return say(`${chosen.by} chose: ${chosen.text}`, { answered: true, choice: chosen.choice, text: chosen.text, by: chosen.by });
    await daemon.command(where, { type: 'choices', id, choices: [] });
    return say('Nobody has chosen an answer.', { answered: false });
  });

  tool('choices', {
    title: 'Offer choices',
    description: 'Shows answers as buttons in a room without waiting; an empty list takes them away.',
    inputSchema: { choices: choices.or(z.array(z.string()).length(0)), question: z.string().max(1000).optional(), room },
  }, async ({ choices: offered, question, room: where }) => {
    await daemon.command(where, without({ type: 'choices', id: randomUUID(), choices: offered, question }));
    return say(offered.length ? 'The choices are on the screen.' : 'The choices are gone.');
  });

  tool('express', {
    title: 'Express',
    description: 'Sets the mood of the face until the next call; an empty list is neutral.',
    inputSchema: {
      mix: mix.describe('Up to four names of faccia://expressions (kind affect).'),
      ease: z.number().min(0).max(10).optional().describe('Seconds that the change takes.'),
      room,
    },
  }, async ({ mix: wished, ease, room: where }) => {
    await daemon.command(where, without({ type: 'express', mix: wished, ease }));
    return say(wished.length ? `The face shows ${wished.map(({ name }) => name).join(', ')}.` : 'The face is neutral.');
  });

  tool('stop', {
    title: 'Stop',
    description: 'Silences the head in a room at once, and forgets what waits to be said.',
    inputSchema: { room },
  }, async ({ room: where }) => {
    await daemon.command(where, { type: 'stop' });
    return say('It is silent.');
  });

  tool('rooms', {
    title: 'Rooms',
    description: 'Lists the rooms in which somebody listens.',
    inputSchema: {},
    annotations: { readOnlyHint: true },
  }, async () => {
    const { rooms } = await daemon.ask('/v1/rooms');
    const lines = rooms.map(({ name, listeners, speaks }) => `${name}: ${heardBy(listeners)}${speaks ? ', speaking' : ''}`);
    return say(lines.join('\n') || 'No room has a listener.', { rooms });
  });

  tool('library_search', {
    title: 'Search the library',
    description: 'Finds words in the texts of the library. A result has the id of its passage, for library_read and say.',
    inputSchema: {
      query: z.string().min(1).max(1000).describe('Words that must all occur; "a phrase"; ama*; OR, NOT, ( ).'),
      lang: z.string().optional(), author: z.string().optional(), work: z.string().optional().describe('Id of a work.'),
      limit: z.number().int().min(1).max(100).optional(),
    },
    annotations: { readOnlyHint: true },
  }, async ({ query, room: _, ...rest }) => {
    const { results } = await daemon.ask(`/v1/library/search?${new URLSearchParams({ q: query, ...rest })}`);
    const found = results.map(({ passage, work, section, snippet }) =>
      ({ passage, work: work.title, section: section.title, text: snippet.text }));
    const line = ({ passage, work, section, text: words }) =>
      `${passage} (${work}${section ? `, ${section}` : ''}): ${words.replaceAll('\n', ' / ')}`;
    return say(found.map(line).join('\n') || 'Nothing was found.', { results: found });
  });

  tool('library_read', {
    title: 'Read from the library',
    description: 'Returns the text of a passage or section of the library (to you; say speaks it to people).',
    inputSchema: { passage: z.string().min(1).max(128).describe('Its id, such as mare:1 (a section) or mare:1:l1.') },
    annotations: { readOnlyHint: true },
  }, async ({ passage }) => {
    const found = await daemon.ask(`/v1/library/passages/${encodeURIComponent(passage)}`);
    const cut = found.text.length > READ_CHARACTERS;
    return say(`${found.text.slice(0, READ_CHARACTERS)}${cut ? '\n[…]' : ''}`, { passage: found.id, work: found.work.title, lang: found.lang, cut });
  });

  tool('film', {
    title: 'Film',
    description: 'Makes a film (MP4 or WebM) of the head as it speaks a text or a passage of the library, and returns its address. It takes about as long as the film lasts, or longer.',
    inputSchema: {
      text: text.optional().describe('What to say: plain text, Markdown, or SSML.'),
      passage: z.string().max(128).optional().describe('Id of a passage or section of the library, instead of a text.'),
      ...speaking,
      format: z.enum(['mp4', 'webm']).optional(),
      model: z.string().max(100).optional().describe('A head of faccia://heads.'),
      size: z.string().regex(/^\d+x\d+$/).optional().describe('Width and height in pixels, such as 640x480.'),
      background: z.string().max(100).optional().describe('A colour as in CSS; transparent for webm.'),
      view: z.enum(['portrait', 'face', 'bust', 'mouth']).optional(),
      captions: z.enum(['burn', 'track']).optional(),
    },
    annotations: { openWorldHint: true },
  }, async ({ room: _, ...order }, { signal, sendNotification, _meta }) => {
    if ((order.text === undefined) === (order.passage === undefined)) throw new DaemonError('Give either text or passage.', 'bad-field');
    const { id } = await daemon.ask('/v1/films', order);
    const address = `/v1/films/${id}`;
    const end = Date.now() + FILM_SECONDS * 1000;
    for (let told = 0; Date.now() < end && !signal.aborted; await sleep(FILM_LOOK_MS)) {
      const { state, progress, film, bytes, error } = await daemon.ask(address);
      if (state === 'failed') throw new DaemonError(error.message, error.code);
      if (state === 'done') return say(`The film is at ${daemon.url}${film}: ${bytes} bytes.`, { film: daemon.url + film, bytes });
      if (_meta?.progressToken !== undefined && progress > told) {
        told = progress;
        await sendNotification({ method: 'notifications/progress', params: { progressToken: _meta.progressToken, progress, total: 1 } });
      }
    }
    await daemon.remove(address);
    throw new DaemonError('The film was not ready in half an hour.', 'too-long');
  });

  const json = (uri, value) => ({ contents: [{ uri: uri.href, mimeType: 'application/json', text: JSON.stringify(value) }] });
  const list = (name, title, path) =>
    server.registerResource(name, `faccia://${name}`, { title, mimeType: 'application/json' }, async (uri) => json(uri, await daemon.ask(path)));
  list('voices', 'Voices', '/v1/voices');
  list('heads', 'Heads', '/v1/models');
  list('expressions', 'Expressions', '/v1/expressions');
  list('library', 'Works of the library', '/v1/library');
  server.registerResource('section', new ResourceTemplate('faccia://library/{work}/{section}', { list: undefined }), {
    title: 'A section of a work', mimeType: 'text/plain',
  }, async (uri, { work, section }) => {
    const { blocks } = await daemon.ask(`/v1/library/works/${encodeURIComponent(work)}/sections/${encodeURIComponent(section)}`);
    return { contents: [{ uri: uri.href, mimeType: 'text/plain', text: plain(blocks) }] };
  });
  return server;
}
