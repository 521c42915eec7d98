// The figures of a page by itself: its size, the time to its first answer, the time of a simulated frame and how many
// frames it shows per second, each the best of five visits in headless Chromium:
//
//     node benchmarks/peers/browser/page.mjs docs/browser/index.html [CHROMIUM]
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { deflateRawSync, gzipSync } from 'node:zlib';
import { openChromium } from '../../../tests/examples/browser/chromium.mjs';
import { partsOf } from '../../../tests/examples/browser/page_parts.mjs';

// Runs in the page: frames per second that it computes and shows, for two seconds.
const framesPerSecond = () => new Promise((done) => {
  const begin = performance.now();
  let frames = 0, last = latest;
  const look = (now) => {
    if (latest !== last) ++frames, last = latest;
    if (now - begin > 2000) done(1000 * frames / (now - begin));
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
});

const [page, chromium = 'chromium'] = process.argv.slice(2);
if (!page) throw new Error('expected a page: page.mjs PAGE [CHROMIUM]');
const visits = [], browser = await openChromium(chromium);
try {
  for (let i = 0; i < 5; ++i) {
    const visit = await browser.openPage(pathToFileURL(resolve(page)).href);
    await visit.until('document.documentElement.dataset.label');
    const perSecond = await visit.evaluate(`(${framesPerSecond})()`);
    const { answered, simulated } = await visit.evaluate('({ ...document.documentElement.dataset })');
    visits.push({ answered: Number(answered), simulated: Number(simulated), perSecond });
    await visit.close();
  }
} finally {
  await browser.close();
}
const all = (what) => visits.map((visit) => visit[what]);
const kilobytes = (bytes) => (bytes.length / 1000).toFixed(0);
const { program, weights } = partsOf(page), compressed = gzipSync(readFileSync(page), { level: 9 }); // as assemble.mjs
console.log(`| the page, compressed | ${kilobytes(compressed)} kB: program ${kilobytes(deflateRawSync(program, { level: 9 }))} kB, weights ${kilobytes(deflateRawSync(weights, { level: 9 }))} kB |
| from opening the file to the first answer | ${(Math.min(...all('answered')) / 1000).toFixed(1)} s |
| one simulated frame | ${Math.min(...all('simulated')).toFixed(1)} ms |
| pictures per second | ${Math.max(...all('perSecond')).toFixed(0)} |`);
