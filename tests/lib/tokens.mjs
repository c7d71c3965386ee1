// SPDX-License-Identifier: GPL-3.0-or-later
// Signs JSON Web Tokens (RFC 7515), valid and unusual ones.
import { createHmac } from 'node:crypto';

export const now = () => Math.floor(Date.now() / 1000);
const part = (object) => Buffer.from(JSON.stringify(object)).toString('base64url');

/** @param {{secret: string, claims?: object, header?: object, hash?: string}} token */
export function sign({ secret, claims = {}, header = {}, hash = 'sha256' }) {
  const signed = `${part({ alg: 'HS256', typ: 'JWT', ...header })}.${part({ sub: 'anna', rights: 'listen speak', exp: now() + 600, ...claims })}`;
  return `${signed}.${createHmac(hash, secret).update(signed).digest('base64url')}`;
}

export const bearer = (token) => ({ headers: { authorization: `Bearer ${token}` } });
