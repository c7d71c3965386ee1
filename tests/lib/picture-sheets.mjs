// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets of pictures, laid out by a browser.
/** @typedef {import('playwright-core').Browser} Browser */

/** @param {Browser} browser @param {Buffer[]} pngs of one height @param {number} gap pixels @returns {Promise<Buffer>} WebP: the pictures beside each other */
export async function besideEachOther(browser, pngs, gap) {
  const page = await browser.newPage();
  const data = await page.evaluate(async ([sources, gap]) => {
    const images = await Promise.all(sources.map(async (source) => {
      const image = new Image();
      image.src = `data:image/png;base64,${source}`;
      await image.decode();
      return image;
    }));
    const canvas = document.createElement('canvas');
    canvas.width = images.reduce((sum, { width }) => sum + width + gap, -gap);
    canvas.height = Math.max(...images.map(({ height }) => height));
    const context = canvas.getContext('2d');
    let x = 0;
    for (const image of images) {
      context.drawImage(image, x, 0);
      x += image.width + gap;
    }
    return canvas.toDataURL('image/webp', 0.86);
  }, [pngs.map((png) => png.toString('base64')), gap]);
  await page.close();
  return Buffer.from(data.split(',')[1], 'base64');
}

/**
 * Pictures with captions, in a grid below each title.
 * @param {Browser} browser @param {{title: string, lang?: string, figures: {png: Buffer, caption: string}[]}[]} parts caption: HTML
 * @param {{columns: number, width: number, gap: number}} layout pixels @returns {Promise<Buffer>} PNG
 */
export async function captioned(browser, parts, { columns, width, gap }) {
  const page = await browser.newPage({ viewport: { width: columns * (width + gap) + gap, height: 400 } });
  const grids = parts.map(({ title, lang = 'en', figures }) => `<h1 lang="${lang}">${title}</h1><main>${figures
    .map(({ png, caption }) => `<figure><img src="data:image/png;base64,${png.toString('base64')}"><figcaption>${caption}</figcaption></figure>`).join('')}</main>`);
  await page.setContent(`<!doctype html><meta charset="utf-8"><style>body{margin:${gap}px;font:13px sans-serif;background:#fff}h1{font-size:15px;margin:6px 0 4px}
    main{display:grid;grid-template-columns:repeat(${columns},${width}px);gap:${gap}px}figure{margin:0;text-align:center}
    img{display:block;width:100%;background:#c8c8c8}</style>${grids.join('')}`);
  const sheet = await page.screenshot({ fullPage: true });
  await page.close();
  return sheet;
}
