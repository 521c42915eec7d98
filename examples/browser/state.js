// The state of the page, and how a link spells it. Also for the tests, which run it in Node.
'use strict';
const OBJECTS = ['adhesive', 'allen key', 'arm', 'ball', 'bottle', 'box', 'branch', 'cable', 'cable pipe', 'caliper', 'can',
  'finger', 'hand', 'highlighter', 'key', 'pen', 'pliers', 'rock', 'rubber', 'scissors', 'sticky tape', 'tube'];
const ROWS = 28, COLUMNS = 50, BOARD = 48;

// Where the page is hosted, such as 'https://example.org/tactnet/'; empty: nowhere. Links that are copied from a file lead there.
const HOSTED = '';

// In the order of networks.hpp. At 28 × 50 the economical form is TactNet-6 itself. The last two: what the network of the page recognises
// of the paper's images, in % (docs/browser.md), in single precision and in 8 bits.
const NETWORKS = [
  ['TactNet-4', 7, 13, 73.2, 73.4], ['TactNet-4', 14, 25, 79.7, 79.8], ['TactNet-4', 28, 50, 78.4, 78.4], ['TactNet-6', 14, 25, 88.3, 88.3],
  ['TactNet-6', 28, 50, 87, 87], ['economical', 7, 13, 74.9, 74.9], ['economical', 10, 18, 82.5, 83.2], ['economical', 14, 25, 86.3, 86.5],
].map(([family, rows, columns, single, eight]) => ({ family, rows, columns, real: { 32: single, 8: eight } }));
const FAMILIES = {
  'TactNet-4': { title: 'TactNet-4', networks: [0, 1, 2] },
  'TactNet-6': { title: 'TactNet-6', networks: [3, 4] },
  economical: { title: 'Economical', networks: [5, 6, 7, 4] },
};

// In the order of simulated_array.hpp; the converter has no switch.
const EFFECTS = [
  { name: 'pad', title: 'Rubber pad', says: '1.6 mm thick, spreads the pressure', on: true },
  { name: 'gain', title: 'Uneven gain', says: '30 % from tactel to tactel' },
  { name: 'texture', title: 'Grainy film', says: 'as of the paper’s sensor', on: true },
  { name: 'linearity', title: 'Non-linear film', says: '20 % of full scale' },
  { name: 'hysteresis', title: 'Hysteresis', says: 'lags behind what is pressed' },
  { name: 'creep', title: 'Creep', says: '20 % per tenfold time of the touch' },
  { name: 'temperature', title: 'Warm sensor', says: '37 °C, 2 % per kelvin' },
  { name: 'crosstalk', title: 'Crosstalk', says: '10 % of each neighbour' },
  { name: 'network', title: 'Resistive network', says: 'currents through other tactels' },
  { name: 'noise', title: 'Noise', says: '1 kPa, four counts' },
  { name: 'threshold', title: 'Threshold', says: 'nothing below 4 kPa' },
  { name: 'saturation', title: 'Saturation', says: 'nothing above 12 kPa' },
  { name: 'converter', hidden: true, on: true },
  { name: 'jpeg', title: 'JPEG file', says: 'quality 75, as the paper’s images', on: true },
];
const LAYER = { name: 'layer', title: 'Elastic layer', says: 'in place of independent springs' };

const defaults = () => ({
  object: 14, touch: 116, place: null, turn: 0, force: null, network: 4, family: 'TactNet-6', bits: 32,
  effects: EFFECTS.map((effect) => Boolean(effect.on)), layer: false, health: true,
  dead: new Set(), stuck: new Set(), strokes: [],
});

const DIGITS = '0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKL'; // 48, one for each place of the board

// A set of tactels, written as whole rows (r5), whole columns (c7) and tactels (10.20).
function spellTactels(set) {
  const words = [], left = new Set(set);
  const whole = (letter, count, places) => {
    for (let i = 0; i < count; ++i)
      if (places(i).every((place) => set.has(place))) { words.push(letter + i); places(i).forEach((place) => left.delete(place)); }
  };
  whole('r', ROWS, (row) => Array.from({ length: COLUMNS }, (_, column) => row * COLUMNS + column));
  whole('c', COLUMNS, (column) => Array.from({ length: ROWS }, (_, row) => row * COLUMNS + column));
  for (const place of left) words.push(`${Math.floor(place / COLUMNS)}.${place % COLUMNS}`);
  return words.join(',');
}
function readTactels(text) {
  const set = new Set();
  for (const word of text.split(',')) {
    const [, letter, line, row, column] = /^(?:([rc])(\d{1,2})|(\d{1,2})\.(\d{1,2}))$/.exec(word) ?? [];
    if (letter === 'r' && line < ROWS) for (let c = 0; c < COLUMNS; ++c) set.add(line * COLUMNS + c);
    else if (letter === 'c' && line < COLUMNS) for (let r = 0; r < ROWS; ++r) set.add(r * COLUMNS + Number(line));
    else if (!letter && row < ROWS && column < COLUMNS) set.add(row * COLUMNS + Number(column));
    else throw 'a row up to r27, a column up to c49 or a tactel such as 10.20';
  }
  return set;
}

function spell(state) {
  const network = NETWORKS[state.network], parts = [];
  const put = (name, value) => parts.push(`${name}=${value}`);
  if (state.strokes.length) put('draw', state.strokes.map((stroke) => stroke.map(([x, y]) => DIGITS[x] + DIGITS[y]).join('')).join('.'));
  else put('object', OBJECTS[state.object].replace(' ', '_')), put('touch', state.touch);
  if (state.place) put('at', `${state.place.x.toFixed(1)},${state.place.y.toFixed(1)}`);
  if (state.turn) put('turn', Math.round(state.turn));
  if (state.force !== null) put('force', state.force.toFixed(1));
  put('network', state.family), put('size', `${network.rows}x${network.columns}`), put('bits', state.bits);
  put('effects', EFFECTS.filter((effect, i) => !effect.hidden && state.effects[i]).map((effect) => effect.name).concat(state.layer ? LAYER.name : []).join(',') || 'none');
  if (state.dead.size) put('dead', spellTactels(state.dead));
  if (state.stuck.size) put('stuck', spellTactels(state.stuck));
  if (!state.health) put('health', 0);
  return parts.join('&');
}

// Returns the state of a link, and a sentence for each part that cannot be read, which keeps its default.
function read(hash) {
  const state = defaults(), problems = [];
  const text = hash.replace(/^#/, '');
  if (!text) return { state, problems };
  const number = (value, least, most) => {
    if (!/^-?\d+(\.\d+)?$/.test(value) || Number(value) < least || Number(value) > most) throw `a number from ${least} to ${most}`;
    return Number(value);
  };
  let size = '28x50';
  const readers = {
    object(value) {
      const index = OBJECTS.indexOf(value.replace('_', ' '));
      if (index < 0) throw 'one of the 22 objects, such as scissors';
      state.object = index;
    },
    touch(value) { state.touch = Math.floor(number(value, 0, 99999)); },
    at(value) {
      const [x, y, ...more] = value.split(',');
      if (y === undefined || more.length) throw 'a column and a row from the middle, such as 3.5,-2';
      state.place = { x: number(x, -40, 40), y: number(y, -30, 30) };
    },
    turn(value) { state.turn = number(value, -180, 180); },
    force(value) { state.force = number(value, 0, 40); },
    network(value) { if (!Object.hasOwn(FAMILIES, value)) throw Object.keys(FAMILIES).join(', '); state.family = value; },
    size(value) { if (!/^(7x13|10x18|14x25|28x50)$/.test(value)) throw '7x13, 10x18, 14x25 or 28x50'; size = value; },
    bits(value) { if (value !== '8' && value !== '32') throw '8 or 32'; state.bits = Number(value); },
    effects(value) {
      const names = value === 'none' ? [] : value.split(',');
      const wrong = names.find((name) => name !== LAYER.name && !EFFECTS.some((effect) => !effect.hidden && effect.name === name));
      if (wrong !== undefined) throw `names such as pad,texture,jpeg, found “${wrong.slice(0, 20)}”`;
      state.effects = EFFECTS.map((effect) => Boolean(effect.hidden) || names.includes(effect.name));
      state.layer = names.includes(LAYER.name);
    },
    dead(value) { state.dead = readTactels(value); },
    stuck(value) { state.stuck = readTactels(value); },
    health(value) { if (value !== '0' && value !== '1') throw '0 or 1'; state.health = value === '1'; },
    draw(value) {
      const strokes = value.split('.').map((stroke) => (stroke.match(/../g) ?? []).map((pair) => [...pair].map((digit) => DIGITS.indexOf(digit))));
      if (!/^[0-9a-zA-L.]+$/.test(value) || value.split('.').some((stroke) => !stroke || stroke.length % 2)) throw 'strokes of the drawing board';
      state.strokes = strokes;
    },
  };
  for (const part of text.split('&')) {
    const [name, value = ''] = part.split(/=(.*)/s);
    try {
      if (!Object.hasOwn(readers, name)) throw 'a part such as object=scissors';
      readers[name](value);
    } catch (expected) {
      problems.push(`Expected ${expected}, found “${part.slice(0, 40)}”.`);
    }
  }
  const named = FAMILIES[state.family].networks.find((i) => size === `${NETWORKS[i].rows}x${NETWORKS[i].columns}`);
  if (named === undefined) problems.push(`${FAMILIES[state.family].title} is not on this page at ${size.replace('x', ' × ')}.`);
  state.network = named ?? FAMILIES[state.family].networks.at(-1);
  return { state, problems };
}

// Millimetres of the underside that strokes of a round pen of 2.4 mm leave; −1 where there is nothing.
function sketchMap(strokes) {
  const map = new Float32Array(BOARD * BOARD).fill(-1), radius = 2.4, cell = 1.2;
  const dab = (x, y) => {
    for (let row = Math.max(0, Math.floor(y - 2)); row <= Math.min(BOARD - 1, y + 2); ++row)
      for (let column = Math.max(0, Math.floor(x - 2)); column <= Math.min(BOARD - 1, x + 2); ++column) {
        const distance = Math.hypot(row - y, column - x) * cell;
        if (distance >= radius) continue;
        const height = radius - Math.sqrt(radius * radius - distance * distance), at = row * BOARD + column;
        if (map[at] < 0 || height < map[at]) map[at] = height;
      }
  };
  for (const stroke of strokes)
    for (let i = 0; i < stroke.length; ++i) {
      const [x, y] = stroke[i], [fromX, fromY] = stroke[Math.max(i - 1, 0)];
      const steps = Math.max(1, Math.ceil(2 * Math.hypot(x - fromX, y - fromY)));
      for (let step = 1; step <= steps; ++step) dab(fromX + (x - fromX) * step / steps, fromY + (y - fromY) * step / steps);
    }
  return map;
}

if (typeof module !== 'undefined') module.exports = { OBJECTS, NETWORKS, FAMILIES, EFFECTS, defaults, spell, read, sketchMap, spellTactels, readTactels };
