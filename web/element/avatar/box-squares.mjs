// SPDX-License-Identifier: MIT

const STEPS_EACH = 10;
const NEGLIGIBLE = 1e-9; // a gradient, as a share of what its variable weighs

/**
 * Least squares within a box: the x of 0 <= x <= 1 that makes |A x - b|^2 + ridge |x|^2 smallest, by the method of active sets
 * on the normal equations (P. B. Stark and R. L. Parker, "Bounded-variable least squares", Computational Statistics 10, 1995).
 * The sets are kept from one right side to the next: near ones are found in a few steps.
 */
export class BoxSquares {
  /** @param {Float64Array[]} gram A'A, with the ridge on its diagonal */
  constructor(gram) {
    const { length } = gram;
    this.gram = gram;
    this.x = new Float64Array(length);
    this.at = new Int8Array(length).fill(-1); // -1 held at 0, 1 held at 1, 0 free
    this.factor = gram.map(() => new Float64Array(length));
    this.wanted = new Float64Array(length);
  }

  /** @param {Float64Array} right A'b @returns {Float64Array} x, the solver's own */
  solve(right) {
    const { x, at } = this;
    const most = STEPS_EACH * x.length;
    for (let steps = 0; steps < most; steps++) {
      if (!this.#go(right)) continue;
      let [best, strongest] = [-1, NEGLIGIBLE];
      for (let i = 0; i < x.length; i++) {
        const pull = at[i] ? (at[i] * this.#gradient(right, i)) / this.gram[i][i] : 0;
        if (pull > strongest) [best, strongest] = [i, pull];
      }
      if (best < 0) break;
      at[best] = 0;
    }
    return x;
  }

  #gradient(right, i) {
    let sum = -right[i];
    for (let k = 0; k < this.x.length; k++) sum += this.gram[i][k] * this.x[k];
    return sum;
  }

  /** Goes towards what the free ones would be, as far as the box lets; what stops it is held. @returns {boolean} there */
  #go(right) {
    const { x, at, wanted } = this;
    const free = [];
    for (let i = 0; i < x.length; i++) if (!at[i]) free.push(i);
    this.#solveFree(right, free);
    let [way, stop] = [1, -1];
    free.forEach((i, n) => {
      const bound = wanted[n] < 0 ? 0 : 1;
      if ((wanted[n] >= 0 && wanted[n] <= 1) || wanted[n] === x[i]) return;
      const part = (bound - x[i]) / (wanted[n] - x[i]);
      if (part < way) [way, stop] = [part, n];
    });
    free.forEach((i, n) => (x[i] += way * (wanted[n] - x[i])));
    if (stop < 0) return true;
    at[free[stop]] = wanted[stop] < 0 ? -1 : 1;
    x[free[stop]] = wanted[stop] < 0 ? 0 : 1;
    return false;
  }

  /** Solves for the free variables without bounds, the others being fixed (Cholesky). */
  #solveFree(right, free) {
    const { gram, factor, wanted, at } = this;
    for (let i = 0; i < free.length; i++) {
      const row = gram[free[i]];
      let rest = right[free[i]];
      for (let k = 0; k < at.length; k++) if (at[k] > 0) rest -= row[k];
      for (let j = 0; j <= i; j++) {
        let sum = row[free[j]];
        for (let k = 0; k < j; k++) sum -= factor[i][k] * factor[j][k];
        factor[i][j] = i === j ? Math.sqrt(sum) : sum / factor[j][j];
      }
      for (let k = 0; k < i; k++) rest -= factor[i][k] * wanted[k];
      wanted[i] = rest / factor[i][i];
    }
    for (let i = free.length; i-- > 0; ) {
      for (let k = i + 1; k < free.length; k++) wanted[i] -= factor[k][i] * wanted[k];
      wanted[i] /= factor[i][i];
    }
  }
}
