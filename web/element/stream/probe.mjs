// SPDX-License-Identifier: MIT
// Why a WebSocket does not open: browsers do not say, but a request for the same address can tell.

/** The server of a stream, as an HTTP origin. @param {string} stream its address */
export const serverOf = (stream) => new URL(stream.replace(/^ws/, 'http')).origin;

function plain(stream) {
  const url = new URL(stream.replace(/^ws/, 'http'));
  url.search = url.hash = ''; // never sends a token to an unknown server
  return url;
}

/**
 * @param {string} stream address of a WebSocket that did not open
 * @param {object} [platform] fetch and document of tests
 * @returns {Promise<'noServer'|'blockedByPolicy'|'forbiddenOrigin'|'wrongAddress'|'serverBusy'>}
 */
export async function reasonOf(stream, { fetch = globalThis.fetch, page = globalThis.document, timeout = 5000 } = {}) {
  const url = plain(stream);
  let forbidden = false;
  const violated = ({ effectiveDirective, blockedURI }) => {
    if (effectiveDirective === 'connect-src' && blockedURI.includes(url.host)) forbidden = true;
  };
  page.addEventListener('securitypolicyviolation', violated);
  const ask = (mode) => fetch(url, { mode, cache: 'no-store', credentials: 'omit', signal: AbortSignal.timeout(timeout) });
  try {
    const answer = await ask('cors').catch(() => null);
    if (answer?.status === 403) return 'forbiddenOrigin';
    if (answer) return [426, 429, 503].includes(answer.status) ? 'serverBusy' : 'wrongAddress';
    const opaque = await ask('no-cors').catch(() => null);
    await new Promise((resolve) => setTimeout(resolve)); // the report of a violation comes a task later
    return forbidden ? 'blockedByPolicy' : opaque ? 'forbiddenOrigin' : 'noServer';
  } finally {
    page.removeEventListener('securitypolicyviolation', violated);
  }
}

/**
 * Whether the server demands a token and this page's requests carried none.
 * @param {string} stream @param {object} [platform] fetch of tests
 */
export async function wantsToken(stream, { fetch = globalThis.fetch } = {}) {
  const answer = await fetch(new URL('rooms', plain(stream)), { cache: 'no-store' }).catch(() => null);
  return answer?.status === 401;
}
