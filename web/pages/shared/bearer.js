// SPDX-License-Identifier: MIT
/** The header by which a request shows a token. @param {string|null|undefined} token @returns {{authorization?: string}} */
export const bearer = (token) => (token ? { authorization: `Bearer ${token}` } : {});
