// A deployed header as WebAssembly: compiles examples/browser/recogniser.cpp, runs its self-test, recognises a frame.
//
//     node recogniser_test.mjs EMXX WRITE_HEADER SOURCES XSIMD FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

const [emxx, writeHeader, sources, xsimd, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
execFileSync(writeHeader, [join(folder, 'recogniser.hpp')]);
const output = join(folder, 'recogniser.wasm');
execFileSync(emxx, ['-std=c++20', '-O2', '-msimd128', '-fno-exceptions', '-fno-rtti', '-I', join(sources, 'include'), '-isystem', xsimd, '-I', folder,
  join(sources, 'examples/browser/recogniser.cpp'), '--no-entry', '-sSTANDALONE_WASM', '-o', output], { stdio: 'inherit' });

const program = readFileSync(output);
const module = await WebAssembly.compile(program);
const calls = [], imports = WebAssembly.Module.imports(module);
assert.deepEqual(imports.filter(({ module: room }) => room !== 'wasi_snapshot_preview1'), [], 'imports of others');
const unused = new Proxy({}, { get: (_, name) => () => { calls.push(name); return 0; } });
const { exports: wasm } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: unused });
wasm._initialize?.();
assert.equal(wasm.passes_selftest(), 1);
const frame = new Uint8Array(wasm.memory.buffer, wasm.counts(), 7 * 13);
frame.fill(0), frame.fill(120, 30, 50);
const label = wasm.classify();
assert.ok(label >= 0 && label < 22);
assert.ok(wasm.probability() > 1 / 22 && wasm.probability() <= 1);
assert.deepEqual(calls, [], 'what it imports is never called');
console.log(`class ${label}, probability ${wasm.probability().toFixed(3)}; ${program.length} bytes, ${gzipSync(program).length} compressed`);
