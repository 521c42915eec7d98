// The page in headless Chromium, opened from its file: it loads, presses, recognises, loses a row and is mended, takes
// links, and says in a sentence what it cannot do without.
//
//     node page_test.mjs CHROMIUM PAGE [SCREENSHOT_FOLDER]
import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openChromium } from './chromium.mjs';

const [chromium, page, pictures] = process.argv.slice(2);
const url = pathToFileURL(resolve(page)).href;
const browser = await openChromium(chromium);
const text = (id) => `document.getElementById('${id}').textContent`;
const visible = (id) => `!document.getElementById('${id}').hidden`;
const probability = `Number(/\\d+/.exec(${text('probability')})?.[0] ?? 0)`;
try {
  // The scene that plays by itself.
  const first = await browser.openPage(url);
  await first.until('document.documentElement.dataset.label');
  console.log(`first answer after ${await first.evaluate('document.documentElement.dataset.answered')} ms`);
  assert.equal(await first.evaluate(`document.documentElement.dataset.label`), 'key');
  await first.until(`${text('time')} !== '–'`);
  console.log(`TactNet-6, single precision: ${await first.evaluate(text('time'))} µs per frame`);
  await first.until(`[...document.querySelectorAll('#objects canvas')].every((one) => one.getContext('2d').getImageData(0, 0, 50, 28).data.some((count, i) => i % 4 === 0 && count > 60))`);

  // It stays a key wherever it is dragged to by a quarter of the array.
  const box = await first.evaluate(`(({ left, top, width, height }) => ({ left, top, width, height }))(document.getElementById('array').getBoundingClientRect())`);
  const drag = async (from, to) => {
    await first.mouse('mousePressed', ...at(...from));
    await first.mouse('mouseMoved', ...at(...to));
    await first.mouse('mouseReleased', ...at(...to));
  };
  const at = (x, y) => [box.left + x * box.width, box.top + y * box.height];
  const middle = await first.evaluate('[nominal.x / 50 + .5, nominal.y / 28 + .5]');
  let from = middle;
  for (const [x, y] of [[.25, 0], [-.25, 0], [0, .25], [0, -.25]]) {
    const to = [middle[0] + x, middle[1] + y];
    await drag(from, to);
    await first.until(`Math.hypot(state.place.x - nominal.x - ${50 * x}, state.place.y - nominal.y - ${28 * y}) < 3`);
    await new Promise((done) => setTimeout(done, 1000)); // until the answer is that of the new place
    await first.until(`document.documentElement.dataset.label === 'key' && ${probability} > 50`, 5);
    from = to;
  }

  // A chosen object, moved by pointer and keys.
  await first.evaluate(`document.querySelector('input[name=object][value="20"]').click()`);
  await first.until(`document.documentElement.dataset.label === 'sticky tape'`);
  const brightest = `(() => { const c = document.getElementById('array'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let x = 0, n = 0; for (let i = 0; i < d.length; i += 4) if (d[i] > 200 && d[i + 1] > 60 && d[i + 2] < 120) x += (i / 4) % c.width, ++n; return x / n / c.width; })()`;
  const before = await first.evaluate(brightest);
  const nominal = await first.evaluate('[nominal.x / 50 + .5, nominal.y / 28 + .5]');
  await drag(nominal, [nominal[0] + .12, nominal[1]]);
  await first.until(`${brightest} > ${before} + .06`);
  await first.evaluate(`document.getElementById('array').focus()`);
  for (let i = 0; i < 6; ++i) await first.key('ArrowLeft');
  await first.until(`${brightest} < ${before} + .06`);
  for (let i = 0; i < 3; ++i) await first.key('e');
  await first.until(`${text('turn-text')} === '15°'`);
  await first.until(`location.hash.includes('object=sticky_tape') && location.hash.includes('turn=15')`);
  await first.until(`${text('live')}.length > 0`); // for a screen reader

  // No force, no answer.
  await first.evaluate(`(() => { const force = document.getElementById('force'); force.value = 0; force.dispatchEvent(new Event('input')); })()`);
  await first.until(`${text('label')} === 'nothing yet'`);

  assert.deepEqual(first.errors, []);
  await first.close();

  // Every network in both formats gives a time and an answer.
  const second = await browser.openPage(`${url}#object=scissors&touch=12`);
  for (const family of ['TactNet-4', 'TactNet-6', 'economical'])
    for (let size = await second.evaluate(`document.querySelector('input[name=family][value="${family}"]').click(), document.getElementById('size').max`); size >= 0; --size)
      for (const bits of [32, 8]) {
        await second.evaluate(`(() => { const size = document.getElementById('size'); size.value = ${size}; size.dispatchEvent(new Event('input')); document.querySelector('input[name=bits][value="${bits}"]').click(); })()`);
        await second.until(`${text('time')} !== '–' && document.documentElement.dataset.label`);
        console.log(`${family}, ${await second.evaluate(text('size-text'))}, ${bits} bits: ${await second.evaluate(text('time'))} µs, ${await second.evaluate('document.documentElement.dataset.label')} ${await second.evaluate(text('probability'))}`);
      }
  await second.evaluate(`document.querySelector('input[name=family][value="TactNet-6"]').click(), document.querySelector('input[name=bits][value="32"]').click()`);
  await second.until(`document.documentElement.dataset.label === 'scissors'`);
  const whole = await second.evaluate(probability);
  assert.ok(whole >= 50, `expected scissors to be probable, found ${whole} %`);

  // A stuck row: the network alone loses its way. The health stage finds it in the air, and mends it under the object.
  const force = (share) => second.evaluate(`(() => { const force = document.getElementById('force'); force.value = ${share}; force.dispatchEvent(new Event('input')); })()`);
  const pressed = await second.evaluate(`document.getElementById('force').value`);
  await second.evaluate(`document.querySelector('input[name=kind][value=stuck]').click(), document.getElementById('break-row').click()`);
  await second.until(`${visible('beside')} && /50 tactels are broken; [1-9]/.test(${text('fault-text')})`);
  await force(0);
  await second.until(`/50 tactels are broken; all found/.test(${text('fault-text')})`);
  await force(pressed);
  await second.until(`document.documentElement.dataset.label === 'scissors' && ${probability} >= 50`);
  assert.notEqual(await second.evaluate(`${text('without-health')}.split(' ')[0]`), 'scissors', 'the network alone');
  await second.evaluate(`document.getElementById('health').click()`);
  await second.until(`document.documentElement.dataset.label !== 'scissors'`);
  await second.evaluate(`document.getElementById('health').click(), document.getElementById('mend').click()`);
  await second.until(`document.documentElement.dataset.label === 'scissors' && !(${visible('beside')})`);

  // Effects: each can be switched, shows its cost and its picture.
  await second.evaluate(`document.getElementById('effects').scrollIntoView()`);
  await second.until(`[...document.querySelectorAll('.cost')].every((one) => / µs$/.test(one.textContent))`, 60);
  const changes = (i) => `[...document.getElementById('difference-${i}').getContext('2d').getImageData(0, 0, 50, 28).data].some((value, i) => i % 4 !== 3 && value !== [255, 255, 255][i % 4])`;
  for (const effect of [0, 1, 2, 7, 9, 13]) await second.until(changes(effect));
  await second.evaluate(`document.querySelector('[data-effect="9"]').click()`);
  await second.until(`location.hash.includes('noise')`);
  console.log('effects: ' + await second.evaluate(`[...document.querySelectorAll('.effect')].map((one) => one.querySelector('b').textContent + ' ' + one.querySelector('.cost').textContent).join(', ')`));
  console.log(`one simulated frame: ${await second.evaluate('document.documentElement.dataset.simulated')} ms`);
  const rate = await second.evaluate(`new Promise((done) => { let frames = 0, begin = performance.now(), last = latest; const look = (now) => { if (latest !== last) ++frames, last = latest; if (now - begin > 2000) done(frames * 1000 / (now - begin)); else requestAnimationFrame(look); }; requestAnimationFrame(look); })`);
  console.log(`${rate.toFixed(0)} pictures per second`);

  // Links, and a drawing.
  const linked = await browser.openPage(`${url}#object=ball&touch=2&network=TactNet-4&size=14x25&bits=8&effects=pad,noise&stuck=r5`);
  await linked.until(`document.documentElement.dataset.label`);
  assert.deepEqual(await linked.evaluate(`[state.family, ${text('size-text')}, state.bits, state.stuck.size, document.querySelector('[data-effect="9"]').checked, ${visible('problem')}]`), ['TactNet-4', '14 × 25', 8, 50, true, false]);
  const sketch = await browser.openPage(`${url}#draw=cocyc2.ycyo`);
  await sketch.until(`${visible('pad')} && document.documentElement.dataset.label`);
  const mangled = await browser.openPage(`${url}#object=spoon&force=9`);
  await mangled.until(`document.documentElement.dataset.label && ${visible('problem')}`);
  assert.match(await mangled.evaluate(text('problem')), /^This link could not be read as a whole\. Expected one of the 22 objects/);

  // A browser that lacks something.
  for (const [before, sentence] of [
    ['delete globalThis.WebAssembly', /computes with WebAssembly, which this browser does not have/],
    ['WebAssembly.validate = () => false', /vector instructions of WebAssembly \(SIMD\), which this browser lacks/],
    ['delete globalThis.DecompressionStream', /DecompressionStream, which this browser lacks/],
    ['WebAssembly.compile = undefined; globalThis.Worker = class { constructor() { throw new Error("no workers here"); } }', /could not start: no workers here/],
  ]) {
    const poor = await browser.openPage(url, { before });
    await poor.until(visible('problem'));
    assert.match(await poor.evaluate(text('problem')), sentence);
  }
  for (const opened of [second, linked, sketch, mangled]) {
    assert.deepEqual(opened.errors, []);
    await opened.close();
  }

  // No width scrolls sideways; the pictures are for people.
  for (const width of [390, 820, 1440])
    for (const dark of [false, true]) {
      const sized = await browser.openPage(url, { width, height: width === 390 ? 844 : 900, dark });
      await sized.until(`document.documentElement.dataset.label && ${text('time')} !== '–'`);
      assert.equal(await sized.evaluate('document.documentElement.scrollWidth'), width, `width of the page at ${width}`);
      if (pictures) {
        mkdirSync(pictures, { recursive: true });
        const name = `${width}_${dark ? 'dark' : 'light'}`;
        writeFileSync(join(pictures, `${name}.png`), await sized.screenshot());
        await sized.evaluate(`document.getElementById('effects').scrollIntoView()`);
        await new Promise((done) => setTimeout(done, 2500));
        await sized.evaluate('scrollTo(0, 0)');
        writeFileSync(join(pictures, `${name}_whole.png`), await sized.screenshot(true));
      }
      await sized.close();
    }
} finally {
  await browser.close();
}
