// The networks of a page, in Node, compared with the same networks in a native program: labels and, within the bound that the
// native program derives, logits in single precision; logits in 8 bits to the bit.
//
//     node same_as_native_test.mjs PAGE NATIVE_PROGRAM FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { partsOf, run } from './page_parts.mjs';

const [page, native, folder] = process.argv.slice(2);
const parts = partsOf(page), wasm = await run(parts);
const NETWORKS = 8, PIXELS = 28 * 50, CLASSES = 22;

mkdirSync(folder, { recursive: true });
const weights = join(folder, 'weights.bin'), tiles = join(folder, 'tiles.txt');
writeFileSync(weights, parts.weights);
let lines = '';
for (let network = 0; network < NETWORKS; ++network) {
  const count = wasm.tiles(network);
  lines += [count, ...new Float64Array(wasm.memory.buffer, wasm.numbers(), 2 * count)].join(' ') + '\n';
}
writeFileSync(tiles, lines);
const touches = JSON.parse(execFileSync(native, [weights, tiles], { maxBuffer: 1 << 28 }));
assert.ok(touches.length >= 8);

const largest = (numbers) => numbers.indexOf(Math.max(...numbers));
let compared = 0, worst = 0;
for (const { label, counts, networks } of touches) {
  assert.equal(networks.length, NETWORKS);
  networks.forEach((expected, network) => {
    new Uint8Array(wasm.memory.buffer, wasm.raw_counts(), PIXELS).set(counts);
    const infer = (bits) => {
      assert.ok(wasm.recognise(network, bits === 8, false), 'logits are finite');
      return [...new Float32Array(wasm.memory.buffer, wasm.logits(), CLASSES)];
    };
    const floats = infer(32), where = `touch of class ${label}, network ${network}`;
    assert.deepEqual([...new Uint8Array(wasm.memory.buffer, wasm.network_frame(network), expected.frame.length)], expected.frame, `${where}: reduced frame`);
    floats.forEach((logit, i) => {
      const difference = Math.abs(logit - expected.logits[i]);
      worst = Math.max(worst, difference / expected.bounds[i]);
      assert.ok(difference <= expected.bounds[i], `${where}, logit ${i}: expected ${expected.logits[i]} to ${expected.bounds[i]}, found ${logit}`);
    });
    assert.equal(largest(floats), largest(expected.logits), `${where}: label`);
    const bytes = infer(8);
    assert.deepEqual(bytes, expected.bytes.map(Math.fround), `${where}: logits in 8 bits`);
    ++compared;
  });
}
console.log(`${compared} answers compared; largest difference ${worst.toExponential(2)} of its bound`);
assert.equal(wasm.effect_count(), 14);

// A file that is cut short or goes on is refused.
for (const size of [parts.weights.length - 1, parts.weights.length + 1]) {
  const wrong = new Uint8Array(wasm.memory.buffer, wasm.weights(size), size);
  wrong.set(parts.weights.subarray(0, size));
  assert.equal(Boolean(wasm.load()), false, `${size} bytes of weights in place of ${parts.weights.length}`);
}
