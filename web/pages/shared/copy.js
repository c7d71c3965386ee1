// SPDX-License-Identifier: MIT
/**
 * Copies a text. Insecure pages may not; then shows the text selected in a field.
 * @param {string} text @param {HTMLTextAreaElement|HTMLInputElement} field @returns {Promise<boolean>} whether it was copied
 */
export async function copy(text, field) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    field.value = text;
    field.hidden = false;
    field.focus();
    field.select();
    return false;
  }
}
