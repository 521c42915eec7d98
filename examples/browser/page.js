'use strict';
const $ = (id) => document.getElementById(id);
const base = () => (location.protocol === 'file:' && HOSTED) || location.href.split('#')[0];

// ---- Colours: inferno of matplotlib as polynomials of the sixth degree (Zucker, 2019), a perceptual map.
const INFERNO = [[0.00022, 0.00165, -0.01948], [0.10651, 0.56396, 3.93271], [11.60249, -3.97285, -15.94239],
  [-41.704, 17.4364, 44.35415], [77.16294, -33.40236, -81.80731], [-71.31943, 32.62606, 73.20952], [25.13113, -12.24267, -23.07033]];
const COLOURS = Array.from({ length: 256 }, (_, count) => {
  const t = 0.05 + 0.95 * count / 255;
  return [0, 1, 2].map((channel) => Math.round(255 * Math.min(1, Math.max(0, INFERNO.reduceRight((sum, c) => sum * t + c[channel], 0)))));
});
$('ramp').style.background = `linear-gradient(90deg, ${[0, 32, 64, 96, 128, 160, 192, 224, 255].map((i) => `rgb(${COLOURS[i]})`).join(',')})`;

const COLOUR_TEXTS = COLOURS.map((colour) => `rgb(${colour})`);
const packed = ([red, green, blue]) => (255 << 24 | blue << 16 | green << 8 | red) >>> 0; // as canvases keep pixels
const COUNTS = Uint32Array.from(COLOURS, packed);
const FAINT_COUNTS = COUNTS.map((_, count) => COUNTS[Math.round(255 * (count / 255) ** .6)]); // a hand shows in a small picture

// Values from `first` on, as pixels of the colours in a table.
function picture(canvas, values, rows, columns, table, first = 0) {
  if (canvas.width !== columns || canvas.height !== rows) canvas.width = columns, canvas.height = rows;
  const context = canvas.getContext('2d'), image = context.createImageData(columns, rows), pixels = new Uint32Array(image.data.buffer);
  for (let i = 0; i < pixels.length; ++i) pixels[i] = table[values[i] - first];
  context.putImageData(image, 0, 0);
}
const isDark = () => (document.documentElement.dataset.theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light')) === 'dark';
// Blue for fewer counts, orange for more; the paper in between.
const differenceTable = (dark) => Uint32Array.from({ length: 511 }, (_, i) => {
  const difference = i - 255, share = Math.min(1, Math.sqrt(Math.abs(difference) / 80));
  const end = difference > 0 ? (dark ? [255, 157, 92] : [194, 65, 12]) : dark ? [125, 182, 255] : [29, 95, 168];
  return packed((dark ? [27, 25, 34] : [255, 255, 255]).map((from, channel) => Math.round(from + (end[channel] - from) * share)));
});
const DIFFERENCES = { light: differenceTable(false), dark: differenceTable(true) };
const put = (element, text) => { if (element.textContent !== text) element.textContent = text; };

// ---- State
let { state, problems } = read(location.hash);
let playing = !location.hash && !matchMedia('(prefers-reduced-motion: reduce)').matches;
let tool = 'press', kind = 'stuck'; // a dead row hardly changes an answer
let nominal = { x: 0, y: 0, force: 8 }; // of the object as it was drawn
let sceneStart = 0, touchStart = performance.now(), sceneIndex = 0, press = 1, sceneMoves = false;
let faultsChanged = true, sketchVersion = 1, latest = null, lastSpoken = '', hashTimer = 0;
// A touch of each object that shows well what it is, and those that the page begins with.
const SHOWN = [3, 12, 0, 0, 8, 0, 5, 12, 4, 3, 3, 3, 3, 3, 116, 0, 5, 10, 5, 12, 1, 1];
const SCENE = ['key', 'sticky tape', 'scissors', 'cable pipe', 'pliers', 'hand', 'caliper', 'rubber', 'bottle', 'adhesive'].map((name) => OBJECTS.indexOf(name));
if (!location.hash) state.object = SCENE[0], state.touch = SHOWN[SCENE[0]];

const say = (sentence) => { $('problem').textContent = sentence, $('problem').hidden = !sentence; };
if (problems.length) say(`This link could not be read as a whole. ${problems.join(' ')} The rest is as the link says.`);

function changed() {
  clearTimeout(hashTimer);
  hashTimer = setTimeout(() => {
    if (playing) return;
    try { history.replaceState(null, '', '#' + spell(state)); } catch { /* some browsers refuse it for files: the button still gives the link */ }
  }, 300);
}
function stopPlaying() {
  if (!playing) return;
  playing = false;
  press = 1;
  showControls();
}

// The effects with a switch, the elastic layer last.
const SWITCHES = [...EFFECTS, LAYER].map((_, i) => i).filter((i) => !EFFECTS[i]?.hidden);

// ---- The worker: one question at a time, the latest state wins.
let worker, asked = 0, busy = false;
const waiting = new Map();
const ask = (what, argument, transfer = []) => new Promise((resolve, reject) => {
  waiting.set(++asked, { resolve, reject });
  worker.postMessage([asked, what, argument], transfer);
});
const SIMD = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

async function start() {
  if (typeof WebAssembly !== 'object') return say('This page computes with WebAssembly, which this browser does not have or has switched off. Any browser of the last years has it.');
  if (!WebAssembly.validate(SIMD)) return say('This page computes with the vector instructions of WebAssembly (SIMD), which this browser lacks: Chrome and Edge have them from 91, Firefox from 89, Safari from 16.4.');
  if (typeof DecompressionStream !== 'function') return say('This page unpacks itself with DecompressionStream, which this browser lacks: Chrome and Edge have it from 103, Firefox from 113, Safari from 16.4.');
  try {
    worker = new Worker(URL.createObjectURL(new Blob([$('worker-text').textContent], { type: 'text/javascript' })));
    worker.onmessage = ({ data: [number, result, error] }) => {
      const { resolve, reject } = waiting.get(number);
      waiting.delete(number);
      if (error) reject(new Error(error)); else resolve(result);
    };
    worker.onerror = (event) => say(`The simulation stopped: ${event.message}.`);
    await ask('start', { wasmBytes: $('wasm-bytes').textContent.trim(), weightBytes: $('weight-bytes').textContent.trim() });
    sceneStart = touchStart = performance.now();
    requestAnimationFrame(tick);
    const { pictures } = await ask('thumbnails', SHOWN);
    faultsChanged = true;
    pictures.forEach((counts, i) => picture($(`object-${i}`), counts, ROWS, COLUMNS, FAINT_COUNTS));
  } catch (error) {
    say(`The simulation could not start: ${error.message}.`);
  }
}

// The slow scene that plays until someone touches anything: each object comes down, turns a little, and leaves.
function playScene(now) {
  const length = 5200, at = now - sceneStart;
  if (at > length) {
    sceneStart = now, sceneIndex = (sceneIndex + 1) % SCENE.length;
    state.object = SCENE[sceneIndex], state.touch = SHOWN[state.object];
    state.place = null, state.force = null, state.turn = 0, touchStart = now, sceneMoves = false;
    showObject();
    return playScene(now);
  }
  const ease = (t) => { const x = Math.min(1, Math.max(0, t)); return x * x * (3 - 2 * x); };
  press = Math.min(.7 + .3 * ease(at / 500), ease((length - at) / 500));
  const swing = Math.sin((at / length) * 2 * Math.PI);
  state.turn = 9 * swing;
  if (sceneMoves) state.place = { x: nominal.x + 2.2 * swing, y: nominal.y + 1.1 * Math.sin((at / length) * 4 * Math.PI) };
}

async function tick(now) {
  requestAnimationFrame(tick);
  if (busy || document.hidden) return;
  busy = true;
  if (playing) playScene(now);
  const message = {
    object: state.object, touch: state.touch, place: state.place, turn: state.turn, force: state.force, press,
    network: state.network, bits: state.bits, size: NETWORKS[state.network], effects: state.effects, layer: state.layer, health: state.health,
    seconds: (now - touchStart) / 1000, timed: SWITCHES, compared: comparedNow(),
    sketch: state.strokes.length ? sketchVersion : 0,
  };
  if (message.sketch && sentSketch !== sketchVersion) message.sketchMap = sketchMap(state.strokes), sentSketch = sketchVersion;
  if (faultsChanged) {
    message.faults = new Uint8Array(ROWS * COLUMNS);
    for (const place of state.dead) message.faults[place] = 1;
    for (const place of state.stuck) message.faults[place] = 2;
    faultsChanged = false;
  }
  try {
    latest = await ask('frame', message);
    if (latest.taken) {
      nominal = latest.taken;
      sceneMoves = true;
      showForce();
    }
    show(latest, message);
  } catch (error) {
    say(`The simulation stopped: ${error.message}. Loading the page again starts it anew.`);
    worker.terminate();
    return;
  }
  busy = false;
}
let sentSketch = 0;
const effectsSeen = { now: false };
new IntersectionObserver((entries) => { effectsSeen.now = entries.at(-1).isIntersecting; }).observe($('effects'));
// Three effects per frame are compared, one after the other, while their pictures are in view.
let compareTurn = 0;
const comparedNow = () => effectsSeen.now ? [0, 1, 2].map(() => SWITCHES[++compareTurn % SWITCHES.length]) : [];

// ---- Pictures of a frame
const array = $('array');
const resized = new ResizeObserver(() => { array.width = Math.round(array.clientWidth * Math.min(2, devicePixelRatio)); array.height = Math.round(array.width * ROWS / COLUMNS); if (latest) drawArray(latest); });
resized.observe(array);
let hover = null;

function drawArray(answer) {
  const context = array.getContext('2d'), cell = array.width / COLUMNS, gap = Math.max(1, cell * .09);
  context.fillStyle = '#08060d';
  context.fillRect(0, 0, array.width, array.height);
  const counts = answer.raw;
  for (let row = 0; row < ROWS; ++row)
    for (let column = 0; column < COLUMNS; ++column) {
      const place = row * COLUMNS + column, count = counts[place];
      const dead = state.dead.has(place), stuck = state.stuck.has(place);
      const shown = (dead || stuck) && state.health ? answer.clean[place] : count;
      context.fillStyle = COLOUR_TEXTS[shown];
      context.fillRect(column * cell + gap / 2, row * cell + gap / 2, cell - gap, cell - gap);
      if (dead || stuck) {
        context.strokeStyle = dead ? '#56c7ff' : '#ffffff';
        context.lineWidth = Math.max(1, cell * .08);
        context.strokeRect(column * cell + cell * .22, row * cell + cell * .22, cell * .56, cell * .56);
      }
    }
  context.strokeStyle = '#ffffffb0', context.lineWidth = Math.max(1, cell * .1);
  if (tool !== 'press' && hover) {
    const [x, y, w, h] = tool === 'row' ? [0, hover.row, COLUMNS, 1] : tool === 'column' ? [hover.column, 0, 1, ROWS] : [hover.column, hover.row, 1, 1];
    context.strokeRect(x * cell, y * cell, w * cell, h * cell);
  } else if (!playing) {
    const at = state.place ?? nominal, x = (at.x + COLUMNS / 2) * cell, y = (at.y + ROWS / 2) * cell;
    const angle = state.turn * Math.PI / 180, arm = cell * 1.5;
    context.strokeStyle = '#ffffff90';
    context.beginPath(), context.arc(x, y, cell * .8, 0, 2 * Math.PI), context.stroke();
    context.beginPath(), context.moveTo(x + Math.cos(angle) * cell * .8, y + Math.sin(angle) * cell * .8), context.lineTo(x + Math.cos(angle) * arm, y + Math.sin(angle) * arm), context.stroke();
  }
}

const best = (probabilities) => { let index = 0; probabilities.forEach((p, i) => { if (p > probabilities[index]) index = i; }); return { name: OBJECTS[index], probability: probabilities[index] }; };
const percent = (p) => `${p > .995 ? '> 99' : p > 0 && p < .005 ? '< 1' : Math.round(100 * p)} %`;

// `asked` is what the worker was asked: by now, the state may be another.
function show(answer, asked) {
  drawArray(answer);
  const { size } = asked, answerBox = document.querySelector('.answer');
  picture($('seen'), answer.seen, size.rows, size.columns, COUNTS);
  const found = best(answer.probabilities), touching = answer.touching && answer.area > 0;
  const truth = asked.sketch ? null : OBJECTS[asked.object];
  answerBox.classList.toggle('unsure', !touching || found.probability < .5);
  put($('label'), touching ? found.name : 'nothing yet');
  put($('probability'), touching ? percent(found.probability) : '');
  put($('verdict'), !touching ? (answer.newtons > 0 ? 'hardly a touch' : 'nothing touches the array') : truth === null ? 'the nearest of 22 objects' : found.name === truth ? 'confidence: correct' : `confidence, but this is: ${truth}`);
  const ranked = [...answer.probabilities].map((p, i) => [p, i]).sort((a, b) => b[0] - a[0]).slice(0, bars.length);
  ranked.forEach(([p, i], rank) => {
    const [name, bar, share] = bars[rank].children;
    put(name, touching ? OBJECTS[i] : '–'), put(share, touching ? percent(p) : '');
    bar.style.setProperty('--share', touching ? p.toFixed(4) : 0);
  });
  const broken = state.dead.size + state.stuck.size;
  $('beside').hidden = broken === 0 || !touching;
  if (broken) {
    const alone = best(answer.alone);
    put($('without-health'), `${alone.name} ${percent(alone.probability)}`);
    put($('with-health'), state.health ? `${found.name} ${percent(found.probability)}` : 'switched off');
  }
  put($('fault-text'), broken ? `${broken} ${broken === 1 ? 'tactel is' : 'tactels are'} broken; ${state.health ? `${answer.found === 0 ? 'none' : answer.found === broken ? 'all' : answer.found} found and filled in from their neighbours.${answer.found < broken && answer.newtons > 0 ? ' Move or lift the object, and it finds the rest.' : ''}` : 'the network sees what they read.'}` : 'No broken cells.');
  const time = answer.costs.network[`${asked.network}/${asked.bits}`];
  if (time && asked.network === state.network && asked.bits === state.bits) {
    put($('time'), time < 10 ? time.toFixed(1) : String(Math.round(time)));
    drawPlot(time);
  }
  for (const [effect, difference] of answer.differences) picture($(`difference-${effect}`), difference, ROWS, COLUMNS, DIFFERENCES[isDark() ? 'dark' : 'light'], -255);
  for (const [effect, cost] of Object.entries(answer.costs.effects)) put($(`cost-${effect}`), microsecondText(cost));
  speak(touching ? `${found.name}, ${percent(found.probability)}` : 'Nothing touches the array');
  document.documentElement.dataset.answered ??= performance.now().toFixed(0);
  document.documentElement.dataset.label = touching ? found.name : '';
  document.documentElement.dataset.simulated = answer.simulated.toFixed(2);
}
const microsecondText = (cost) => `${cost < .5 ? '< 0.5' : cost < 10 ? cost.toFixed(1) : Math.round(cost)} µs`;

let spokenAt = 0, spokenSoon = '';
function speak(text) { // an answer that has settled for a second; not each frame, and not while the scene plays by itself
  if (text.split(',')[0] !== spokenSoon.split(',')[0]) spokenAt = performance.now();
  spokenSoon = text;
  if (playing || performance.now() - spokenAt < 1000 || text.split(',')[0] === lastSpoken.split(',')[0]) return;
  lastSpoken = text, $('live').textContent = text;
  array.setAttribute('aria-label', `Pressure on the tactile array: ${text}`);
}

// ---- The picture of accuracy and time
const STUDY = /* study */[];
function drawPlot(measured) {
  const chosen = NETWORKS[state.network], plot = $('plot');
  const left = 40, right = 408, top = 16, bottom = 256, x = (time) => left + (right - left) * Math.log(time / .3) / Math.log(200 / .3), y = (accuracy) => bottom - (bottom - top) * Math.log(30 / (100 - accuracy)) / Math.log(30 / 1.5); // errors on a log scale
  const colour = { 'TactNet-4': 'var(--less)', 'TactNet-6': 'var(--accent)', economical: 'var(--good)' };
  const is = (point) => point.rows === chosen.rows && point.columns === chosen.columns && (point.family === state.family || point.family === chosen.family);
  const here = STUDY.find((point) => is(point) && point.bits === state.bits) ?? STUDY.find(is);
  const key = JSON.stringify([state.network, state.bits, measured.toPrecision(2)]);
  if (plot.dataset.key === key) return;
  plot.dataset.key = key;
  let drawing = '';
  for (const time of [.5, 1, 2, 5, 10, 20, 50, 100, 200]) drawing += `<line class="axis" x1="${x(time)}" x2="${x(time)}" y1="${top}" y2="${bottom}"/><text x="${x(time)}" y="${bottom + 15}" text-anchor="middle">${time}</text>`;
  for (const accuracy of [75, 80, 85, 90, 95, 98]) drawing += `<line class="axis" x1="${left}" x2="${right}" y1="${y(accuracy)}" y2="${y(accuracy)}"/><text x="${left - 6}" y="${y(accuracy) + 4}" text-anchor="end">${accuracy}</text>`;
  drawing += `<text x="${right}" y="${bottom + 31}" text-anchor="end">time per frame, µs (log scale)</text><text x="${left - 34}" y="${top - 1}">accuracy on real touches, % (errors on a log scale)</text>`;
  for (const point of STUDY) drawing += `<circle cx="${x(point.time)}" cy="${y(point.accuracy)}" r="4.5" fill="${point.bits === 8 ? 'var(--card)' : colour[point.family]}" stroke="${colour[point.family]}" stroke-width="1.6"/>`;
  if (here) {
    const to = Math.min(right, x(measured)), level = y(chosen.real[state.bits]), end = to > right - 90;
    drawing += `<circle cx="${x(here.time)}" cy="${y(here.accuracy)}" r="9" fill="none" stroke="var(--ink)" stroke-width="1.6"/><path d="M${to} ${level - 6}l6 6-6 6-6-6z" fill="var(--ink)"/>`;
    drawing += `<text class="here" x="${to + (end ? 0 : 12)}" y="${level + (end ? 22 : 4)}" text-anchor="${end ? 'end' : 'start'}">this page</text>`;
  }
  plot.innerHTML = drawing;
  $('plot-text').innerHTML = `${here ? `${FAMILIES[here.family].title} at ${here.rows} × ${here.columns}${here.bits === 8 ? ' in 8 bits' : ''}: ${here.accuracy.toFixed(1)} % of the paper’s real touches, when trained on real ones, in ${here.time.toFixed(1)} µs on an AMD Zen 5 core (ring); ${chosen.real[state.bits].toFixed(1)} % as on this page, trained on simulated ones, in ${measured.toFixed(1)} µs in this browser (diamond). ` : ''}<span style="color:${colour['TactNet-4']}">●</span> TactNet-4 <span style="color:${colour['TactNet-6']}">●</span> TactNet-6 <span style="color:${colour.economical}">●</span> economical; hollow points are in 8 bits.`;
}

// ---- Controls
const bars = Array.from({ length: 7 }, () => {
  const item = document.createElement('li');
  item.innerHTML = '<span></span><i></i><b></b>';
  return $('bars').appendChild(item);
});
function choice(id, options, chosen, choose) {
  for (const [value, title] of options) {
    const label = document.createElement('label');
    label.innerHTML = `<input type="radio" name="${id}" value="${value}"><span>${title}</span>`;
    const input = label.firstChild;
    input.checked = value === chosen;
    input.addEventListener('change', () => choose(value));
    $(id).append(label);
  }
}
const check = (name, value) => document.querySelectorAll(`input[name="${name}"]`).forEach((input) => { input.checked = input.value === String(value); });
OBJECTS.forEach((name, i) => {
  const label = document.createElement('label');
  label.innerHTML = `<input type="radio" name="object" value="${i}"><canvas id="object-${i}" width="50" height="28" aria-hidden="true"></canvas>${name}`;
  label.firstChild.addEventListener('change', () => takeObject(i, SHOWN[i]));
  $('objects').append(label);
});
const sketch = document.createElement('label');
sketch.innerHTML = '<input type="radio" name="object" value="drawn"><span class="sketch"><svg viewBox="0 0 16 16" aria-hidden="true"><path d="M3 13l1-3.2 7-7 2.2 2.2-7 7zM9.6 4.2l2.2 2.2"/></svg></span>draw one';
sketch.firstChild.addEventListener('change', () => {
  stopPlaying(), newTouch();
  if (!state.strokes.length) state.strokes = [[[10, 24], [38, 24]]], ++sketchVersion; // something to press from the start
  showObject(), changed();
});
$('objects').append(sketch);

function newTouch() { state.place = null, state.turn = 0, state.force = null, touchStart = performance.now(), showControls(), changed(); }
function takeObject(object, touch) { stopPlaying(); state.strokes = [], state.object = object, state.touch = touch; newTouch(), showObject(); }
function showObject() {
  check('object', state.strokes.length ? 'drawn' : state.object);
  $('pad').hidden = !state.strokes.length, drawBoard();
}
const mostForce = 30;
function showForce() {
  const force = state.force ?? nominal.force;
  $('force').value = Math.round(100 * Math.sqrt(force / mostForce)), $('force-text').textContent = `${force.toFixed(1)} N`;
  $('force').setAttribute('aria-valuetext', `${force.toFixed(1)} newtons`);
}
function showControls() {
  $('play').textContent = playing ? 'Pause' : 'Play';
  $('turn').value = state.turn, $('turn-text').textContent = `${Math.round(state.turn)}°`;
  showForce();
}
function setForce(force) { stopPlaying(), state.force = Math.min(mostForce, Math.max(0, force)), showForce(), changed(); }
function setTurn(turn) { stopPlaying(), state.turn = ((turn + 540) % 360) - 180, showControls(), changed(); }
function move(x, y) { stopPlaying(); state.place = { x: Math.max(-30, Math.min(30, x)), y: Math.max(-19, Math.min(19, y)) }, changed(); }
$('force').addEventListener('input', () => setForce(mostForce * ($('force').value / 100) ** 2));
$('turn').addEventListener('input', () => { stopPlaying(), state.turn = Number($('turn').value), showControls(), changed(); });
$('next').addEventListener('click', () => another());
const another = () => state.strokes.length ? takeObject(state.object, state.touch) : takeObject(state.object, state.touch + 1);
$('play').addEventListener('click', () => {
  if (playing) return stopPlaying();
  playing = true, sceneStart = -1e9, sceneIndex = SCENE.length - 1, state.strokes = [];
  showControls();
});

function showSizes() {
  const { networks, title } = FAMILIES[state.family], place = networks.indexOf(state.network), { rows, columns } = NETWORKS[state.network];
  $('size').max = networks.length - 1, $('size').value = place;
  $('size-text').textContent = `${rows} × ${columns}`, $('size').setAttribute('aria-valuetext', `${rows} by ${columns} tactels`);
  $('seen-size').textContent = `${rows} × ${columns}`;
  $('seen').setAttribute('aria-label', `The image that ${title} reads, ${rows} by ${columns}`);
  $('time').textContent = '–';
}
choice('family', Object.entries(FAMILIES).map(([name, { title }]) => [name, title]), state.family, (family) => {
  const { rows } = NETWORKS[state.network], { networks } = FAMILIES[family];
  state.family = family, state.network = networks.find((i) => NETWORKS[i].rows === rows) ?? networks.at(-1);
  showSizes(), changed();
});
$('size').addEventListener('input', () => { state.network = FAMILIES[state.family].networks[$('size').value], showSizes(), changed(); });
choice('bits', [[32, 'single precision'], [8, '8 bits']], state.bits, (bits) => { state.bits = bits, $('time').textContent = '–', changed(); });
choice('tool', [['press', 'press'], ['tactel', 'break a cell'], ['row', 'a row'], ['column', 'a column']], tool, (value) => { tool = value, array.classList.toggle('breaks', tool !== 'press'); });
choice('kind', [['dead', 'dead: reads 0'], ['stuck', 'stuck: reads 255']], kind, (value) => { kind = value; });
$('health').addEventListener('change', () => { state.health = $('health').checked, changed(); });

function breakPlaces(places) {
  const target = state[kind], mends = places.every((place) => state.dead.has(place) || state.stuck.has(place));
  for (const place of places) { state.dead.delete(place), state.stuck.delete(place); if (!mends) target.add(place); }
  faultsChanged = true, changed();
}
const rowPlaces = (row) => Array.from({ length: COLUMNS }, (_, column) => row * COLUMNS + column);
const columnPlaces = (column) => Array.from({ length: ROWS }, (_, row) => row * COLUMNS + column);
$('break-row').addEventListener('click', () => breakPlaces(rowPlaces(Math.max(1, Math.min(ROWS - 2, Math.round((state.place ?? nominal).y + ROWS / 2 - .5))))));
$('mend').addEventListener('click', () => { state.dead.clear(), state.stuck.clear(), faultsChanged = true, changed(); });

[...EFFECTS, LAYER].forEach((effect, i) => {
  if (effect.hidden) return;
  const row = document.createElement('div');
  row.className = 'effect';
  row.innerHTML = `<label class="switch"><input type="checkbox" role="switch"><i></i><span><b>${effect.title}</b><small>${effect.says}</small></span></label><span class="cost" id="cost-${i}">–</span><canvas id="difference-${i}" width="50" height="28" role="img" aria-label="What ${effect.title} changes"></canvas>`;
  const input = row.querySelector('input');
  input.dataset.effect = i;
  input.addEventListener('change', () => { if (effect === LAYER) state.layer = input.checked; else state.effects[i] = input.checked; changed(); });
  $('effects').append(row);
});

// The array under the pointer
const placeOf = (event) => { const box = array.getBoundingClientRect(); return { x: (event.clientX - box.left) / box.width * COLUMNS - COLUMNS / 2, y: (event.clientY - box.top) / box.height * ROWS - ROWS / 2 }; };
let grip = null;
array.addEventListener('pointerdown', (event) => {
  array.setPointerCapture(event.pointerId);
  const at = placeOf(event);
  if (tool === 'press') {
    stopPlaying();
    const now = state.place ?? nominal, near = Math.hypot(at.x - now.x, at.y - now.y) < 6;
    grip = near ? { x: now.x - at.x, y: now.y - at.y } : { x: 0, y: 0 };
    move(at.x + grip.x, at.y + grip.y);
  } else {
    const row = Math.max(0, Math.min(ROWS - 1, Math.floor(at.y + ROWS / 2))), column = Math.max(0, Math.min(COLUMNS - 1, Math.floor(at.x + COLUMNS / 2)));
    breakPlaces(tool === 'row' ? rowPlaces(row) : tool === 'column' ? columnPlaces(column) : [row * COLUMNS + column]);
  }
});
array.addEventListener('pointermove', (event) => {
  const at = placeOf(event);
  hover = { row: Math.floor(at.y + ROWS / 2), column: Math.floor(at.x + COLUMNS / 2) };
  if (grip) move(at.x + grip.x, at.y + grip.y);
});
for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) array.addEventListener(end, () => { grip = null; });
array.addEventListener('pointerleave', () => { hover = null; });
array.addEventListener('wheel', (event) => { if (event.shiftKey || !grip) return; event.preventDefault(), setTurn(state.turn + Math.sign(event.deltaY) * 4); }, { passive: false });
array.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const step = event.shiftKey ? 5 : 1, at = state.place ?? nominal, force = state.force ?? nominal.force;
  const keys = {
    ArrowLeft: () => move(at.x - step, at.y), ArrowRight: () => move(at.x + step, at.y), ArrowUp: () => move(at.x, at.y - step), ArrowDown: () => move(at.x, at.y + step),
    q: () => setTurn(state.turn - 5), e: () => setTurn(state.turn + 5), '+': () => setForce(force * 1.15 + .1), '=': () => setForce(force * 1.15 + .1), '-': () => setForce(force / 1.15 - .1),
    n: another, ' ': () => $('play').click(),
  };
  const action = keys[event.key] ?? keys[event.key.toLowerCase()];
  if (action) event.preventDefault(), action();
});

// The drawing board
const board = $('board');
let stroke = null;
function drawBoard() {
  if ($('pad').hidden) return;
  const context = board.getContext('2d'), cell = board.width / BOARD;
  context.clearRect(0, 0, board.width, board.height);
  sketchMap(state.strokes).forEach((height, i) => {
    if (height < 0) return;
    context.fillStyle = `rgb(${COLOURS[Math.round(235 - 75 * height)]})`;
    context.fillRect(i % BOARD * cell, Math.floor(i / BOARD) * cell, cell + .5, cell + .5);
  });
}
const boardPlace = (event) => { const box = board.getBoundingClientRect(), at = (share) => Math.max(0, Math.min(BOARD - 1, Math.floor(share * BOARD))); return [at((event.clientX - box.left) / box.width), at((event.clientY - box.top) / box.height)]; };
board.addEventListener('pointerdown', (event) => { stopPlaying(), board.setPointerCapture(event.pointerId), stroke = [boardPlace(event)], state.strokes.push(stroke), redrawn(); });
board.addEventListener('pointermove', (event) => {
  if (!stroke) return;
  const at = boardPlace(event), last = stroke.at(-1);
  if (at[0] !== last[0] || at[1] !== last[1]) stroke.push(at), redrawn();
});
for (const end of ['pointerup', 'pointercancel']) board.addEventListener(end, () => { stroke = null; });
function redrawn() { ++sketchVersion, state.place = { x: 0, y: 0 }, drawBoard(), changed(); }
$('wipe').addEventListener('click', () => { state.strokes = [[[24, 24]]], redrawn(); });

$('theme').addEventListener('click', () => { document.documentElement.dataset.theme = isDark() ? 'light' : 'dark', showTheme(); });
const showTheme = () => $('theme').setAttribute('aria-pressed', isDark());
$('link').addEventListener('click', async () => {
  stopPlaying();
  const link = base() + '#' + spell(state);
  try { await navigator.clipboard.writeText(link), $('link-text').textContent = 'Copied.'; } catch { location.hash = spell(state), $('link-text').textContent = 'The link is in the address bar.'; }
});
addEventListener('hashchange', () => {
  if (location.hash.slice(1) === spell(state)) return;
  ({ state, problems } = read(location.hash));
  say(problems.length ? `This link could not be read as a whole. ${problems.join(' ')} The rest is as the link says.` : '');
  playing = false, press = 1, faultsChanged = true, ++sketchVersion, touchStart = performance.now(), showAll();
});
function showAll() {
  check('family', state.family), check('bits', state.bits), $('health').checked = state.health;
  document.querySelectorAll('[data-effect]').forEach((input) => { input.checked = Number(input.dataset.effect) === EFFECTS.length ? state.layer : state.effects[input.dataset.effect]; });
  showSizes(), showObject(), showControls(), showTheme();
}
showAll();
start();
