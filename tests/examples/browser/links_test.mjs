// Links that hold the state of the page: what is spelt is read again, and what is mangled gets a sentence.
//
//     node links_test.mjs STATE_JS
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const { NETWORKS, defaults, spell, read, spellTactels, readTactels, sketchMap } = createRequire(import.meta.url)(resolve(process.argv[2]));

const state = defaults();
Object.assign(state, { object: 14, touch: 12, place: { x: -3.5, y: 7.2 }, turn: -45, force: 12.5, network: 6, family: 'economical', bits: 8, layer: true, health: false });
state.effects[9] = true;
for (let column = 0; column < 50; ++column) state.dead.add(5 * 50 + column);
state.stuck.add(20 * 50 + 3);
const link = spell(state), again = read('#' + link);
assert.deepEqual(again.problems, []);
assert.deepEqual(again.state, state);
assert.match(link, /dead=r5&stuck=20\.3/);

const drawn = { ...defaults(), strokes: [[[0, 47], [10, 12]], [[24, 24]]] };
assert.deepEqual(read(spell(drawn)).state.strokes, drawn.strokes);
assert.deepEqual(read('').state, defaults());

const column = readTactels('c7,3.7');
assert.equal(column.size, 28);
assert.equal(spellTactels(column), 'c7');

for (const [mangled, sentence] of [
  ['object=spoon', 'Expected one of the 22 objects, such as scissors, found “object=spoon”.'],
  ['force=lots', 'Expected a number from 0 to 40, found “force=lots”.'],
  ['at=1', 'Expected a column and a row from the middle, such as 3.5,-2, found “at=1”.'],
  ['dead=r28', 'Expected a row up to r27, a column up to c49 or a tactel such as 10.20, found “dead=r28”.'],
  ['effects=pad,magic', 'Expected names such as pad,texture,jpeg, found “magic”, found “effects=pad,magic”.'],
  ['%%%', 'Expected a part such as object=scissors, found “%%%”.'],
  ['constructor=1', 'Expected a part such as object=scissors, found “constructor=1”.'],
  ['network=TactNet-6&size=7x13', 'TactNet-6 is not on this page at 7 × 13.'],
  ['draw=abc', 'Expected strokes of the drawing board, found “draw=abc”.'],
]) {
  const { problems, state: kept } = read('#turn=30&' + mangled);
  assert.deepEqual(problems, [sentence], mangled);
  assert.equal(kept.turn, 30, 'the rest is read');
  assert.ok(kept.network >= 0 && kept.network < 8);
}

const map = sketchMap([[[24, 24]]]);
assert.equal(map[24 * 48 + 24], 0, 'the lowest point of the pen');
assert.ok(map[24 * 48 + 25] > 0 && map[0] === -1);

// The page of documentation has the same figures: accuracies on real images, and the size that the page states.
const docs = new URL('../../../docs/', import.meta.url), text = (name) => readFileSync(new URL(name, docs), 'utf8'), figures = text('browser.md');
for (const { family, rows, columns, real } of NETWORKS)
  assert.match(figures, new RegExp(`\n\\| ${family.replace('economical', 'economical TactNet-6')}, ${rows} × ${columns} \\|[^|]*\\|[^|]*\\| ${real[32].toFixed(1)} \\| ${real[8].toFixed(1)} \\|`));
assert.ok(figures.includes(`| the page, compressed | ${/file of (\d+) kB/.exec(text('browser/index.html'))[1]} kB:`), 'the size of the page');
console.log('links: all as expected');
