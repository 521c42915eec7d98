// Pictures of docs/browser/index.html in headless Chromium, light and dark: pliers on an array with a stuck row.
//
//     node browser.mjs PAGE FOLDER [CHROMIUM]
import { writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openChromium } from '../../../tests/examples/browser/chromium.mjs';

const [page, folder, chromium = 'chromium'] = process.argv.slice(2);
if (!folder) throw new Error('expected a page and a folder: browser.mjs PAGE FOLDER [CHROMIUM]');
const link = pathToFileURL(resolve(page)).href + '#object=pliers&touch=9&stuck=r9';
const width = 1320, height = 900, browser = await openChromium(chromium);
try {
  for (const dark of [false, true]) {
    const visit = await browser.openPage(link, { width, height, dark });
    await visit.ask('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1.5, mobile: false });
    await visit.until('document.documentElement.dataset.label');
    await new Promise((done) => setTimeout(done, 3000)); // until the time per frame has settled
    if (visit.errors.length > 0) throw new Error(visit.errors.join('; '));
    // The array and the answer, with a margin.
    const { x, y, right, bottom } = await visit.evaluate(`document.getElementById('stage').getBoundingClientRect().toJSON()`);
    const clip = { x: x - 12, y: y - 12, width: right - x + 24, height: bottom - y + 24, scale: 1 };
    const { data } = await visit.ask('Page.captureScreenshot', { format: 'png', clip });
    writeFileSync(join(folder, dark ? 'browser_dark.png' : 'browser.png'), Buffer.from(data, 'base64'));
    await visit.close();
  }
} finally {
  await browser.close();
}
