// The page in a real browser, Debian's Chromium without a display, beside a rehearsal in real time.
// page_test.mjs PROGRAM [FOLDER]: with FOLDER it leaves a picture of each view there.

import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {test, after, before, beforeEach} from 'node:test';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const require = createRequire(join(here, '../../build/page/'));  // where tools/peers has put them
const [program, pictures] = process.argv.slice(2);
const kChromium = '/usr/bin/chromium', kPatience = 30_000;
const kPhone = {viewport: {width: 390, height: 844}, deviceScaleFactor: 2, hasTouch: true, isMobile: true};
const kLaptop = {viewport: {width: 1280, height: 800}};

let chromium, axe;
try {
  ({chromium} = require('playwright-core'));
  axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
} catch { /* said below */ }
if (!chromium || !existsSync(kChromium)) {
  console.log('skipped: the page in a browser: Chromium or its driver is not installed: tools/peers installs them');
  process.exit(77);
}
if (pictures) mkdirSync(pictures, {recursive: true});

// A rehearsal whose page is at a port.
class Run {
  static async begin(port = 0) {
    const run = new Run();
    run.said = '';
    run.process = spawn(program, ['rehearse', here, '--site', here, '--by-hand', '--seconds', '900', '--console', `localhost:${port}`],
      {stdio: ['ignore', 'ignore', 'pipe']});
    run.process.stderr.on('data', (text) => { run.said += text; });
    run.ended = new Promise((done) => run.process.on('close', done));
    run.address = await comes(() => /http:\/\/localhost:\d+\//.exec(run.said)?.[0], () => 'the page is nowhere: ' + run.said);
    run.port = Number(new URL(run.address).port);
    return run;
  }
  async end(signal = 'SIGINT') {
    this.process.kill(signal);
    await this.ended;
  }
  async ask(path) { return (await fetch(this.address + path)).json(); }
  async state() { return (await this.ask('api/v1/state')).state; }
  async press(wish) {
    const answer = await fetch(`${this.address}api/v1/inputs`,
      {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(wish)});
    return answer.json();
  }
}
async function comes(look, why) {
  for (const until = Date.now() + kPatience; Date.now() < until;) {
    const seen = await look();
    if (seen) return seen;
    await new Promise((done) => setTimeout(done, 20));
  }
  assert.fail(typeof why === 'function' ? why() : why);
}

let run, browser;
before(async () => {
  run = await Run.begin();
  browser = await chromium.launch({executablePath: kChromium, args: ['--no-sandbox', '--disable-gpu']});
});
after(async () => {
  await browser?.close();
  await run?.end();
});
// Each test begins in the dark, with nothing held.
beforeEach(async () => {
  const {holds} = await run.state();
  if (holds.panic) await run.press({do: 'restore'});
  for (const hold of ['pause', 'freeze', 'lock']) if (holds[hold]) await run.press({do: hold});
  await run.press({do: 'blackout', on: false});
  await run.press({do: 'master', level: 1});
  await run.press({do: 'release'});
  await run.press({do: 'jump', cue: '1'});
  await new Promise((done) => setTimeout(done, 350));  // the show's go_interval
});

async function open(kind = kPhone, address = run.address) {
  const context = await browser.newContext(kind);
  const page = await context.newPage();
  page.faults = [];
  page.on('pageerror', (fault) => page.faults.push(String(fault)));
  page.on('console', (line) => { if (line.type() === 'error' && !/ERR_|Failed to load resource/.test(line.text())) page.faults.push(line.text()); });
  await page.goto(address);
  await page.getByText('connected', {exact: true}).waitFor();
  return page;
}
async function close(page) {
  assert.deepEqual(page.faults, []);
  await page.context().close();
}
const text = (page, id) => page.locator(`#${id}`).innerText();
async function shows(page, id, wanted) {
  await comes(async () => (await text(page, id)).includes(wanted), () => `#${id} never said '${wanted}'`);
}
// Does what presses something until it counts: on a busy machine a press may be too late to count.
async function counts(page, press) {
  const {inputs} = await run.state();
  await press();
  await comes(async () => {
    if ((await run.state()).inputs > inputs) return true;
    if ((await text(page, 'said')).includes('busy')) await press();
    return false;
  }, 'it never counts');
}
const go = (page) => counts(page, () => page.locator('#go').tap());
async function picture(page, name) { if (pictures) await page.screenshot({path: join(pictures, `${name}.png`)}); }
async function hold(page, id) {
  const box = await page.locator(`#${id}`).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.waitForTimeout(700);
  await page.mouse.up();
}
// Several touches at the same moment, however busy the machine is.
const touch = (page, id, times) => page.evaluate(([id, times]) => {
  const button = document.getElementById(id);
  for (let i = 0; i < times; ++i)
    for (const what of ['pointerdown', 'pointerup']) button.dispatchEvent(new PointerEvent(what, {button: 0, bubbles: true}));
}, [id, times]);

test('GO enters the next cue, once for each touch, and the page says what comes', async () => {
  const page = await open();
  assert.equal(await text(page, 'now-name'), 'Dusk');
  assert.equal(await text(page, 'next-name'), 'Storm');
  assert.equal(await text(page, 'next-number'), '2.5');
  assert.match(await text(page, 'now-does'), /wall: blue.*gate 40 %/s);
  await picture(page, 'phone');
  await go(page);
  await shows(page, 'now-name', 'Storm');
  await shows(page, 'fade-left', 'begins in');
  assert.equal((await run.state()).lists[0].cue.name, 'Storm');
  await page.waitForTimeout(350);
  await go(page);
  await shows(page, 'now-name', 'Quiet');
  await shows(page, 'follow', 'follows by itself in');
  await close(page);
});

test('a second touch within the interval is ignored, and the page says why', async () => {
  const page = await open();
  await counts(page, () => touch(page, 'go', 2));
  await shows(page, 'said', 'too soon');
  assert.equal((await run.state()).lists[0].cue.name, 'Storm');
  await close(page);
});

test('a key works GO once, however long it is held', async () => {
  const page = await open(kLaptop);
  await page.locator('#go').focus();
  await counts(page, () => page.keyboard.press('Enter'));
  await shows(page, 'now-name', 'Storm');
  await page.waitForTimeout(350);
  await counts(page, () => page.keyboard.press('Space'));
  await shows(page, 'now-name', 'Quiet');
  await picture(page, 'laptop');
  await close(page);
});

test('blackout and panic want to be held', async () => {
  const page = await open();
  await touch(page, 'blackout', 3);
  await page.waitForTimeout(700);
  assert.equal((await run.state()).holds.blackout, false, 'a touch is not enough');
  await hold(page, 'blackout');
  await shows(page, 'holds', 'BLACKOUT');
  assert.equal((await run.state()).holds.blackout, true);
  await hold(page, 'panic');
  await shows(page, 'holds', 'PANIC');
  await picture(page, 'panic');
  assert.equal(await text(page, 'panic'), 'Restore');
  await counts(page, () => hold(page, 'panic'));
  assert.equal((await run.state()).holds.panic, false);
  await page.locator('#blackout').focus();
  await page.keyboard.down('Enter');
  await page.waitForTimeout(700);
  await page.keyboard.up('Enter');
  await comes(async () => !(await run.state()).holds.blackout, 'the key never lights');
  await close(page);
});

test('a cue of the list is loaded, or entered after a question', async () => {
  const page = await open();
  await page.getByRole('button', {name: 'The very last cue'}).click();
  assert.equal((await run.state()).lists[0].cue.name, 'Dusk', 'a touch enters nothing');
  await picture(page, 'choice');
  await page.getByRole('button', {name: 'Leave it'}).click();
  const choose = (cue, what) => counts(page, async () => {
    await page.getByRole('button', {name: cue}).click();
    await page.getByRole('button', {name: what}).click();
  });
  await choose('The very last cue', 'Load: GO enters it');
  await shows(page, 'next-name', 'The very last cue');
  await choose('Quiet', 'Go to it now');
  await shows(page, 'now-name', 'Quiet');
  await close(page);
});

test('pause, freeze, back, master and another list', async () => {
  const page = await open(kLaptop);
  const click = (name) => counts(page, () => page.getByRole('button', {name, exact: true}).click());
  await click('Pause');
  await shows(page, 'holds', 'PAUSED');
  const before = await text(page, 'fade-left');
  await page.waitForTimeout(1500);
  assert.equal(await text(page, 'fade-left'), before, 'nothing counts down in a pause');
  await click('Pause');
  await click('Freeze');
  await shows(page, 'holds', 'FROZEN');
  await page.getByText('Master, lamps and relays, lock').click();
  await counts(page, () => page.locator('#master').fill('40'));
  await shows(page, 'holds', 'MASTER 40 %');
  await page.getByRole('button', {name: 'Bar'}).click();
  await click('GO');
  await shows(page, 'now-name', 'Warm');
  assert.equal((await run.state()).lists[1].cue.name, 'Warm');
  assert.equal((await run.state()).lists[0].cue.name, 'Dusk', 'the other list stays');
  await close(page);
});

test('a lamp is raised and a relay switched by hand, and both are released', async () => {
  const page = await open();
  await page.getByText('Master, lamps and relays, lock').click();
  await page.getByText('gate: 40 %').waitFor();
  await counts(page, () => page.getByLabel('bar by hand').fill('90'));
  await shows(page, 'holds', 'bar at least 90 % by hand');
  await page.getByText('bar: 90 %').waitFor();
  await counts(page, () => page.getByRole('button', {name: 'fog: off'}).click());
  await page.getByRole('button', {name: 'fog: on by hand'}).waitFor();
  await picture(page, 'lamps');
  await counts(page, () => page.getByRole('button', {name: 'Release'}).click());
  await page.getByRole('button', {name: 'fog: off'}).waitFor();
  assert.deepEqual((await run.state()).raised, []);
  await close(page);
});

test('two phones and a laptop see the same', async () => {
  const pages = [await open(kPhone), await open(kPhone), await open(kLaptop)];
  await go(pages[1]);
  for (const page of pages) await shows(page, 'now-name', 'Storm');
  for (const page of pages) await close(page);
});

test('the page comes back by itself after the program was killed, and fires no old press', async () => {
  const another = await Run.begin();
  const page = await open(kPhone, another.address);
  await another.end('SIGKILL');
  await shows(page, 'connection', 'NO CONNECTION');
  await picture(page, 'lost');
  assert.equal(await page.locator('#go').isDisabled(), true);
  await page.locator('#go').dispatchEvent('pointerdown', {button: 0});
  await shows(page, 'said', 'did not count');
  const again = await Run.begin(another.port);
  await shows(page, 'connection', 'connected');
  await shows(page, 'now-name', 'no cue yet');
  assert.equal((await again.state()).inputs, 0);
  await comes(async () => {
    if ((await again.state()).inputs === 0) await page.locator('#go').tap();
    return (await text(page, 'now-name')) === 'Dusk';
  }, 'GO never counts');
  await close(page);
  await again.end();
});

test('nothing changes: at most 1 kB a second', async () => {
  await run.press({do: 'jump', cue: '4'});
  await new Promise((done) => setTimeout(done, 1500));
  const abort = new AbortController();
  let bytes = 0;
  const answer = await fetch(`${run.address}api/v1/events`, {signal: abort.signal});
  const reading = (async () => { try { for await (const chunk of answer.body) bytes += chunk.length; } catch { /* ended */ } })();
  await new Promise((done) => setTimeout(done, 10_000));
  abort.abort();
  await reading;
  assert.ok(bytes > 0 && bytes <= 10_000, `${bytes} bytes in ten seconds`);
});

for (const [name, kind] of [['phone', kPhone], ['laptop', kLaptop]])
  test(`on a ${name}, axe finds nothing that keeps people out, and nothing is cut off at 200 %`, async () => {
    await run.press({do: 'highlight', lamp: 'gate'});
    await run.press({do: 'raise', lamp: 'gate', level: 0.5});
    const page = await open(kind);
    await page.locator('#more summary').click();
    await page.evaluate(axe);
    const {violations} = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.target).join(', ')}`), []);
    await page.setViewportSize({width: Math.round(kind.viewport.width / 2), height: Math.round(kind.viewport.height / 2)});
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.ok(wide <= 0, `${wide} pixels are cut off`);
    await run.press({do: 'highlight', lamp: ''});
    await close(page);
  });
