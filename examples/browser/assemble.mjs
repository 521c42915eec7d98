// Puts the page into one file that opens from anywhere: node assemble.mjs PAGE.wasm WEIGHTS STUDY.csv OUTPUT.html
import { readFileSync, writeFileSync } from 'node:fs';
import { deflateRawSync, gzipSync } from 'node:zlib';

const [wasmFile, weightFile, studyFile, output] = process.argv.slice(2);
if (!output) {
  console.error('assemble.mjs: expected the program, the weights, the study and the page to write');
  process.exit(2);
}
const source = (name) => readFileSync(new URL(name, import.meta.url), 'utf8');
const packed = (file) => {
  const bytes = readFileSync(file), page = /id="weight-bytes">([^<]*)</.exec(bytes.subarray(0, 15).toString() === '<!doctype html>' ? bytes.toString() : '');
  return page ? Buffer.from(page[1], 'base64') : deflateRawSync(bytes, { level: 9 });
};

// Each network of the study at its default recipe, or as published where there is no other.
const [head, ...rows] = readFileSync(studyFile, 'utf8').trim().split('\n').map((line) => line.split(','));
const families = { tactnet4: 'TactNet-4', tactnet6: 'TactNet-6', 'tactnet6-economical': 'economical' };
const study = new Map();
for (const row of rows) {
  const value = (name) => row[head.indexOf(name)];
  const key = ['method', 'rows', 'columns', 'bits'].map(value).join();
  if (!(value('method') in families) || !['default', 'published'].includes(value('recipe')) || (study.has(key) && value('recipe') !== 'default')) continue;
  study.set(key, { family: families[value('method')], rows: Number(value('rows')), columns: Number(value('columns')), bits: Number(value('bits')),
    accuracy: Number((100 * value('random_accuracy')).toFixed(2)), time: Number(Number(value('microseconds')).toFixed(2)) });
}

const wasm = packed(wasmFile), weights = packed(weightFile);
// Replaces in the page's own text alone, so that no file can end a script early.
const kilobytes = (bytes) => Math.round(bytes / 1000).toString();
const fill = (size) => {
  const values = {
    css: source('page.css'), state: source('state.js'), worker: source('worker.js'), js: source('page.js').replace('/* study */[]', JSON.stringify([...study.values()])),
    'wasm bytes': wasm.toString('base64'), 'weight bytes': weights.toString('base64'),
    wasm: kilobytes(wasm.length), weights: kilobytes(weights.length), kilobytes: size,
  };
  return source('page.html').replace(/@(css|state|worker|js|wasm bytes|weight bytes|wasm|weights|kilobytes)@/g, (_, name) => values[name]);
};
const size = kilobytes(gzipSync(fill('000'), { level: 9 }).length);
const page = fill(size);
writeFileSync(output, page);
console.log(`${output}: ${page.length} bytes, ${gzipSync(page, { level: 9 }).length} compressed; program ${wasm.length}, weights ${weights.length} compressed`);
