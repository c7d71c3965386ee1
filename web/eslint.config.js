// SPDX-License-Identifier: MIT
const browser = Object.fromEntries(
  `AbortController AbortSignal indexedDB Audio AudioContext CSS CSSStyleSheet devicePixelRatio DOMPoint Event EventTarget Highlight NodeFilter caches Element getSelection scrollTo self navigator IntersectionObserver AudioWorkletNode Blob CustomEvent HTMLElement MutationObserver Option ResizeObserver
   TextDecoder TextEncoder URL URLSearchParams WebSocket getComputedStyle history localStorage sessionStorage ImageData btoa
  addEventListener DOMMatrix Worker atob cancelAnimationFrame clearInterval clearTimeout console createImageBitmap customElements document
  fetch globalThis matchMedia location performance queueMicrotask removeEventListener requestAnimationFrame setInterval setTimeout`
    .split(/\s+/)
    .map((name) => [name, 'readonly']),
);

export default [
  {
    files: ['**/*.{js,mjs}'],
    languageOptions: { ecmaVersion: 2024, sourceType: 'module', globals: { ...browser, process: 'readonly' } },
    rules: {
      'no-undef': 'error',
      'no-unused-vars': ['error', { argsIgnorePattern: '^_', varsIgnorePattern: '^_' }],
      'no-dupe-keys': 'error',
      'no-unreachable': 'error',
      'no-fallthrough': 'error',
      'no-var': 'error',
      'prefer-const': 'error',
      eqeqeq: ['error', 'always'],
      'max-len': ['error', { code: 128, ignoreUrls: true, ignoreStrings: true, ignoreTemplateLiterals: true }],
    },
  },
];
