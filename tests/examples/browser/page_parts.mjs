// The parts of a built page: its program, running, and its weights.
import { readFileSync } from 'node:fs';
import { inflateRawSync } from 'node:zlib';

export function partsOf(page) {
  const html = readFileSync(page, 'utf8');
  const part = (id) => {
    const found = new RegExp(`id="${id}">([^<]+)<`).exec(html);
    if (!found) throw new Error(`${page}: expected an element ${id}`);
    return inflateRawSync(Buffer.from(found[1], 'base64'));
  };
  return { program: part('wasm-bytes'), weights: part('weight-bytes') };
}

export async function run({ program, weights }) {
  const module = await WebAssembly.compile(program), imports = {};
  for (const { module: room, name } of WebAssembly.Module.imports(module))
    (imports[room] ??= {})[name] = () => { throw new Error(`the program calls ${room}.${name}`); };
  const { exports: wasm } = await WebAssembly.instantiate(module, imports);
  wasm._initialize?.();
  new Uint8Array(wasm.memory.buffer, wasm.weights(weights.length), weights.length).set(weights);
  if (!wasm.load()) throw new Error('the weights do not belong to the networks');
  return wasm;
}
