// The networks of the page in docs/browser compared with onnxruntime-web with one thread and with a native build, with the
// same weights: prints the tables of docs/browser.md.
//
//     npm install --prefix FOLDER onnxruntime-web@1.30 && cmake --build build --target benchmark_browser
//     node benchmarks/peers/browser/compare.mjs FOLDER/node_modules
//
// Options: --images FOLDER recognises the images in it, one subfolder per class; --rounds 200, of which the fastest
// counts; --page and --program name another page and another place of benchmark_browser; --chromium names the browser.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { openChromium } from '../../../tests/examples/browser/chromium.mjs';
import { partsOf, run } from '../../../tests/examples/browser/page_parts.mjs';

// Runs in the browser: per network the fastest time of each in microseconds per frame, and how far the logits of
// onnxruntime-web are from the page's. Throws if they do not agree, before it times.
async function timeNetworks(runPage, networks, rounds) {
  const ort = await import('/ort.wasm.min.mjs');
  Object.assign(ort.env.wasm, { numThreads: 1, wasmPaths: '/' });
  const bytesOf = async (url) => new Uint8Array(await (await fetch(url)).arrayBuffer());
  const wasm = await runPage({ program: await bytesOf('/program'), weights: await bytesOf('/weights') });
  const CLASSES = 22, MICROSECONDS_PER_ROUND = 500;
  const logits = () => new Float32Array(wasm.memory.buffer, wasm.logits(), CLASSES);

  const results = [];
  for (const [place, { name, rows, columns, terms }] of networks.entries()) {
    const session = await ort.InferenceSession.create(await bytesOf(`/${place}.onnx`), { executionProviders: ['wasm'], graphOptimizationLevel: 'all' });
    const memory = () => new Uint8Array(wasm.memory.buffer, wasm.network_frame(place), rows * columns);
    let frame, frames, difference = 0;
    for (let label = 0; label < CLASSES; ++label) {
      wasm.take_object(label, 12);
      const [x, y, amount] = new Float64Array(wasm.memory.buffer, wasm.numbers(), 3);
      wasm.simulate(x, y, 0, amount, 0);
      if (!wasm.recognise(place, false, false)) throw new Error(`${name}: logits that are not finite`);
      frame = memory().slice();
      frames = new ort.Tensor('float32', Float32Array.from(frame), [1, 1, rows, columns]);
      const theirs = (await session.run({ frames })).logits.data, ours = logits();
      const distance = Math.max(...ours.map((logit, i) => Math.abs(logit - theirs[i])));
      // Each of the terms of a sum may be rounded once.
      const bound = 2 ** -24 * terms * Math.max(...ours.map(Math.abs));
      if (!(distance <= bound)) throw new Error(`${name}, class ${label}: expected the logits of onnxruntime-web within ${bound}, found them at ${distance}`);
      difference = Math.max(difference, distance);
    }

    const infer = (inBytes) => {
      memory().set(frame);
      wasm.infer(place, inBytes);
      return logits()[0];
    };
    const inferences = { single: () => infer(false), bytes: () => infer(true), onnxruntime: () => session.run({ frames }) };
    const time = async (what, times) => {
      const begin = performance.now();
      if (what === 'onnxruntime') for (let i = 0; i < times; ++i) await inferences.onnxruntime();
      else for (let i = 0; i < times; ++i) inferences[what]();
      return 1000 * (performance.now() - begin) / times;
    };
    const times = {}, fastest = {};
    for (const what in inferences) {
      let rough = Infinity;
      for (let i = 0; i < 10; ++i) rough = Math.min(rough, await time(what, 30)); // meanwhile the browser compiles it
      times[what] = Math.ceil(MICROSECONDS_PER_ROUND / rough);
      fastest[what] = Infinity;
    }
    for (let round = 0; round < rounds; ++round)
      for (const what in inferences) fastest[what] = Math.min(fastest[what], await time(what, times[what]));
    results.push({ ...fastest, difference });
  }
  return results;
}

// Serves a page without content, isolated, since clocks are finer there, and the files that timeNetworks fetches.
async function serve(parts, folder, runtime) {
  const server = http.createServer(({ url }, response) => {
    const name = basename(url), file = [join(folder, name), join(runtime, name)].find((path) => name && existsSync(path));
    const body = url === '/' ? '<!doctype html><title>networks</title>' : parts[name] ?? (file && readFileSync(file));
    const type = { '': 'text/html', mjs: 'text/javascript', wasm: 'application/wasm' }[url === '/' ? '' : name.split('.').pop()];
    response.writeHead(body ? 200 : 404, {
      'Content-Type': type ?? 'application/octet-stream', 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    response.end(body);
  });
  await new Promise((done) => server.listen(0, 'localhost', done));
  return server;
}

const short = (number) => number >= 9.95 ? number.toFixed(0) : number.toFixed(1);
const mean = (ratios) => Math.exp(ratios.reduce((sum, ratio) => sum + Math.log(ratio), 0) / ratios.length);
const print = (rows) => rows.forEach((cells, i) => console.log(`| ${cells.join(' | ')} |${i ? '' : '\n' + '|---'.repeat(cells.length) + '|'}`));

const ofRepository = (path) => fileURLToPath(new URL(`../../../${path}`, import.meta.url));
const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    images: { type: 'string' },
    rounds: { type: 'string', default: '200' },
    page: { type: 'string', default: ofRepository('docs/browser/index.html') },
    program: { type: 'string', default: ofRepository('build/bin/benchmark_browser') },
    chromium: { type: 'string', default: 'chromium' },
  },
});
const runtime = join(positionals[0] ?? '', 'onnxruntime-web');
if (positionals.length !== 1 || !existsSync(join(runtime, 'package.json')))
  throw new Error(`expected a folder node_modules with onnxruntime-web, found ${positionals.join(' ') || 'none'}`);
const rounds = Number(options.rounds);
if (!(Number.isInteger(rounds) && rounds > 0)) throw new Error(`--rounds: expected a number from 1, found ${options.rounds}`);
const { version } = JSON.parse(readFileSync(join(runtime, 'package.json'), 'utf8'));

const folder = mkdtempSync(join(tmpdir(), 'tactnet-networks-'));
try {
  const parts = partsOf(options.page), weights = join(folder, 'weights.bin');
  writeFileSync(weights, parts.weights);
  const { native, networks } = JSON.parse(execFileSync(options.program, [weights, folder, options.rounds, options.images].filter(Boolean)));
  const server = await serve(parts, folder, join(runtime, 'dist'));
  const browser = await openChromium(options.chromium);
  let times;
  try {
    const page = await browser.openPage(`http://localhost:${server.address().port}/`);
    await page.evaluate(`void (globalThis.measure = () => (${timeNetworks})(${run}, ${JSON.stringify(networks)}, ${rounds}))`);
    times = await page.evaluate('measure()');
  } finally {
    await browser.close();
    server.close();
  }

  const ratios = networks.map(({ microseconds }, i) => [times[i].single / microseconds.single, times[i].onnxruntime / times[i].single, times[i].onnxruntime / times[i].bytes]);
  const averages = ratios[0].map((_, column) => short(mean(ratios.map((row) => row[column]))));
  const difference = Math.max(...times.map((one) => one.difference));
  console.log(`Microseconds per frame: in the browser, ÷ native (${native}), onnxruntime-web ${version}; its logits differ by ${difference.toExponential(0)} at most.\n`);
  print([
    ['network', 'single precision', '÷ native', '8 bits', 'onnxruntime-web', '÷ single precision', '÷ 8 bits'],
    ...networks.map(({ name }, i) => [name, short(times[i].single), short(ratios[i][0]), short(times[i].bytes), short(times[i].onnxruntime), short(ratios[i][1]), short(ratios[i][2])]),
    ['geometric mean', '', averages[0], '', '', averages[1], averages[2]],
  ]);
  if (options.images) {
    console.log('\nImages that are recognised, natively:\n');
    print([
      ['network', 'single precision, %', '8 bits, %'],
      ...networks.map(({ name, recognised }) => [name, recognised.single.toFixed(1), recognised.bytes.toFixed(1)]),
    ]);
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
