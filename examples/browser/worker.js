// Simulates and recognises, away from the page's own thread. It receives the state of the page, and answers
// with one frame. state.js lists networks and effects in the order of the C++.
'use strict';
const PIXELS = 28 * 50, CLASSES = 22;
let wasm, memory, turn = 0, lastTimed = 0, lastKey = '';
const costs = { network: {}, effects: {} };
let known = {}, held; // what the C++ was given last, and the object as it was drawn

const decoded = async (base64) => {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};
const bytesAt = (at, count = PIXELS) => new Uint8Array(memory.buffer, at, count).slice();
const floatsAt = (at, count) => new Float32Array(memory.buffer, at, count).slice();
const numbers = (count) => [...new Float64Array(memory.buffer, wasm.numbers(), count)];

// Microseconds of one call of `body(times)` per time: browsers round their clocks, so it runs for some milliseconds, and
// other programs disturb it, so that the fastest of three counts.
function microseconds(body, atLeast = 2) {
  const run = (times) => {
    const start = performance.now();
    body(times);
    return performance.now() - start;
  };
  for (let times = 4; ; times *= 4) {
    const fastest = Math.min(run(times), run(times), run(times)); // long enough also if nothing disturbed it
    if (fastest >= atLeast || times > 1e6) return fastest * 1000 / times;
  }
}

async function start({ wasmBytes, weightBytes }) {
  const [program, weights] = await Promise.all([decoded(wasmBytes), decoded(weightBytes)]);
  const stop = () => { throw new Error('the program stopped'); };
  // What a program without files and clocks still asks for: nothing of it is ever called in earnest.
  const imports = { env: {}, wasi_snapshot_preview1: {} };
  const module = await WebAssembly.compile(program);
  for (const { module: room, name } of WebAssembly.Module.imports(module)) imports[room][name] = stop;
  ({ exports: wasm } = await WebAssembly.instantiate(module, imports));
  memory = wasm.memory;
  wasm._initialize?.();
  new Uint8Array(memory.buffer, wasm.weights(weights.length), weights.length).set(weights);
  if (!wasm.load()) throw new Error('the weights do not belong to these networks');
  return { kilobytes: Math.round(program.length / 1024) };
}

// A small picture of each object, pressed as it was drawn.
function thumbnails(count, number) {
  const pictures = [];
  for (let label = 0; label < count; ++label) {
    wasm.take_object(label, number[label]);
    const [x, y, force] = numbers(3);
    wasm.simulate(x, y, 0, force, 0);
    pictures.push(bytesAt(wasm.sound_counts()));
  }
  known = {};
  wasm.learn();
  return { pictures };
}

// Brings the C++ to the page's state, as far as it has changed.
function follow(state) {
  for (let i = 0; i < state.effects.length; ++i)
    if (known.effects?.[i] !== state.effects[i]) wasm.set_effect(i, state.effects[i]);
  if (known.layer !== state.layer) wasm.set_layer(state.layer);
  let taken = null;
  if (state.sketch ? known.sketch !== state.sketch : known.sketch || known.object !== state.object || known.touch !== state.touch) {
    if (state.sketch) {
      new Float32Array(memory.buffer, wasm.drawing(), state.sketchMap.length).set(state.sketchMap);
      wasm.take_drawing();
    } else {
      wasm.take_object(state.object, state.touch);
    }
    const [x, y, force] = numbers(3);
    taken = { x, y, force };
  }
  if (state.faults) {
    // A sensor that is mended as a whole is a new one.
    new Uint8Array(memory.buffer, wasm.faults(), PIXELS).set(state.faults);
    if (!state.faults.some((fault) => fault)) wasm.learn();
  }
  known = { effects: [...state.effects], layer: state.layer, object: state.object, touch: state.touch, sketch: state.sketch };
  return taken;
}

function recognised(state, clean) {
  wasm.recognise(state.network, state.bits === 8, clean);
  return floatsAt(wasm.probabilities(), CLASSES);
}

function frame(state) {
  const taken = follow(state);
  held = taken ?? held;
  const at = state.place ?? held, force = (state.force ?? held.force) * state.press;
  const began = performance.now();
  wasm.simulate(at.x, at.y, state.turn * Math.PI / 180, force, state.seconds);
  const simulated = performance.now() - began;
  const [area, largest, found, touching, newtons, depth] = numbers(6);
  const answer = { taken, area, largest, found, touching: touching > 0, newtons, depth, simulated };
  answer.raw = bytesAt(wasm.raw_counts());
  answer.clean = bytesAt(wasm.clean_counts());
  answer.alone = recognised(state, false);
  answer.probabilities = state.health ? recognised(state, true) : answer.alone;
  answer.seen = bytesAt(wasm.network_frame(state.network), state.size.rows * state.size.columns);
  answer.differences = state.compared.map((effect) => {
    if (effect === state.effects.length) wasm.compare_layer(state.seconds, state.layer);
    else wasm.compare(effect, state.seconds, state.effects[effect]);
    return [effect, new Int16Array(memory.buffer, wasm.difference(), PIXELS).slice()];
  });
  answer.costs = measured(state, largest > 0);
  return answer;
}

// One measurement now and then: of the network, or of one effect after the other, those without a figure first.
function measured(state, pressed) {
  const now = performance.now(), key = `${state.network}/${state.bits}`, isNew = !(key in costs.network);
  if (key !== lastKey || (!isNew && now - lastTimed < 300)) { // the first answer does not wait
    lastKey = key;
    return costs;
  }
  lastTimed = now;
  if (isNew || ++turn % 4 === 0) {
    costs.network[key] = Math.min(microseconds((times) => wasm.repeat_network(state.network, state.bits === 8, times)), costs.network[key] ?? Infinity);
    return costs;
  }
  if (!pressed) return costs; // effects take less time in air
  const unmeasured = state.timed.filter((effect) => !(effect in costs.effects));
  const effect = unmeasured[0] ?? state.timed[turn % state.timed.length];
  let taken;
  if (effect === state.effects.length) {
    taken = microseconds((times) => wasm.repeat_contact(true, times)) - microseconds((times) => wasm.repeat_contact(false, times));
    wasm.set_layer(state.layer);
  } else {
    taken = microseconds((times) => wasm.repeat_effect(effect, times));
  }
  costs.effects[effect] = Math.min(taken, costs.effects[effect] ?? Infinity);
  return costs;
}

onmessage = async ({ data: [number, what, argument] }) => {
  try {
    const result = what === 'start' ? await start(argument) : what === 'thumbnails' ? thumbnails(argument.length, argument) : frame(argument);
    postMessage([number, result]);
  } catch (error) {
    postMessage([number, null, String(error.message ?? error)]);
  }
};
