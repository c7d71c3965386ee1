// SPDX-License-Identifier: MIT
/**
 * Copies a text. A page that is not secure may not: then the text is shown in a field, selected.
 * @param {string} text @param {HTMLTextAreaElement|HTMLInputElement} field @returns {Promise<boolean>} whether it is copied
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
