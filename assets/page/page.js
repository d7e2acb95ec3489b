// The page of a running show. It asks for nothing but this machine's /api/v1 (docs/api.md).

const kAgain = 300;       // ms until a lost connection is tried again
const kSilence = 12_000;  // ms without a sign of life, after which it counts as lost
const kAnswer = 1500;     // ms to wait for the answer to a press
const kHold = 500;        // ms to hold a button that makes it dark

const $ = (id) => document.getElementById(id);
let state = null;      // as /api/v1/state has it; null before the first
let clock = null;      // show time, cue time and whether that moves, and when the page heard so
let list = '';         // that GO, back and load are for
let cuesOf = -1;       // the revision of the cues on the page
let cues = {lists: []};
let heard = 0;         // when the connection last gave a sign of life
let newsShown = 0;

// --- The connection

let events = null;
function connect() {
  if (events) events.close();
  events = new EventSource('/api/v1/events');
  events.onmessage = (event) => { heard = performance.now(); take(JSON.parse(event.data)); };
  events.addEventListener('alive', () => { heard = performance.now(); });
  events.onerror = lose;
}
function lose() {
  if (!events) return;
  events.close();
  events = null;
  clock = null;
  draw();
  setTimeout(connect, kAgain);
}
setInterval(() => { if (events && state && performance.now() - heard > kSilence) lose(); }, 1000);
for (const [what, where] of [['online', window], ['pageshow', window], ['visibilitychange', document]])
  where.addEventListener(what, () => { if (document.visibilityState === 'visible' && performance.now() - heard > kSilence) connect(); });

function take(moment) {
  const now = performance.now() / 1000, before = clock;
  state = moment.state;
  clock = {...moment.clock, heard: now};
  // How far show time is ahead of the page's own. An event that came late makes this too small, and presses look
  // older than they are. So the largest counts, less a little for clocks that drift.
  clock.ahead = before ? Math.max(before.ahead - 0.001, clock.show - now) : clock.show - now;
  if (!state.lists.some((one) => one.name === list)) list = '';
  if (state.revision !== cuesOf) loadCues(state.revision);
  if (state.news !== newsShown) loadNews(state.news);
  draw();
}
async function loadCues(revision) {
  cuesOf = revision;
  try { cues = await (await fetch('/api/v1/cues')).json(); } catch { cuesOf = -1; }
  drawCues();
}
async function loadNews(count) {
  const after = newsShown;
  newsShown = count;
  try {
    const {news} = await (await fetch(`/api/v1/news?after=${after}`)).json();
    for (const one of news) {
      const item = document.createElement('li'), time = document.createElement('time');
      time.textContent = duration(one.at);
      item.append(time, one.text);
      $('news').prepend(item);
    }
    while ($('news').children.length > 200) $('news').lastChild.remove();
  } catch { newsShown = after; }
}

// --- What is pressed

let count = 0;
const page = crypto.getRandomValues(new Uint32Array(2)).join('-');
async function press(wish) {
  if (!clock) return say('no connection: this did not count');
  const at = clock.ahead + performance.now() / 1000;
  const body = JSON.stringify({...wish, at, press: `${page}-${++count}`});
  try {
    const answer = await fetch('/api/v1/inputs', {
      method: 'POST', body, headers: {'Content-Type': 'application/json'}, signal: AbortSignal.timeout(kAnswer)});
    const told = await answer.json();
    if (told.error) say(told.error);
    else if (!told.taken) say(`${wish.do}: ${told.outcome}`);
    else say('');
  } catch { say('no answer: look whether it counted before you press again'); }
}
function say(text) { $('said').textContent = text; }

// GO counts when it is touched, once until it is let go. A key that repeats counts once.
$('go').addEventListener('pointerdown', (event) => { if (event.button === 0) press({do: 'go', list}); });
$('go').addEventListener('click', (event) => { if (event.detail === 0) press({do: 'go', list}); });
$('back').onclick = () => press({do: 'back', list});
$('pause').onclick = () => press({do: 'pause'});
$('freeze').onclick = () => press({do: 'freeze'});
$('lock').onclick = () => press({do: 'lock'});
$('release').onclick = () => press({do: 'release'});
$('master').oninput = () => { $('master-level').textContent = `${$('master').value} %`; };
$('master').onchange = () => press({do: 'master', level: Number($('master').value) / 100});

function onHold(button, act) {
  let timer = 0;
  const begin = () => {
    if (timer || button.disabled) return;
    button.classList.add('held');
    timer = setTimeout(() => { end(); act(); }, kHold);
  };
  const end = () => { clearTimeout(timer); timer = 0; button.classList.remove('held'); };
  button.addEventListener('pointerdown', (event) => { if (event.button === 0) begin(); });
  for (const what of ['pointerup', 'pointercancel', 'pointerleave', 'blur']) button.addEventListener(what, end);
  button.addEventListener('keydown', (event) => { if ((event.key === ' ' || event.key === 'Enter') && !event.repeat) begin(); });
  button.addEventListener('keyup', end);
  button.addEventListener('contextmenu', (event) => event.preventDefault());
}
onHold($('blackout'), () => press({do: 'blackout', on: !state.holds.blackout}));
onHold($('panic'), () => press({do: state.holds.panic ? 'restore' : 'panic'}));

let chosen = null;
function choose(cue) {
  chosen = cue;
  $('choice-title').textContent = `${cue.number} ${cue.name}`;
  $('choice-does').textContent = cue.does;
  $('choice').showModal();
}
$('choice-load').onclick = () => { $('choice').close(); press({do: 'load', list, cue: chosen.number}); };
$('choice-jump').onclick = () => { $('choice').close(); press({do: 'jump', list, cue: chosen.number}); };
$('choice-cancel').onclick = () => $('choice').close();

// --- What is seen

function duration(time) {
  const whole = Math.max(0, Math.ceil(time - 1e-3)), minutes = Math.floor(whole / 60), two = (n) => String(n).padStart(2, '0');
  if (whole < 60) return `${whole} s`;
  return minutes < 60 ? `${minutes}:${two(whole % 60)} min` : `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(whole % 60)}`;
}
function fill(id, text) { if ($(id).textContent !== text) $(id).textContent = text; }

const kHolds = {
  panic: 'PANIC: hold Restore to go on', blackout: 'BLACKOUT: hold Blackout to light', pause: 'PAUSED: GO or Pause goes on',
  freeze: 'FROZEN: Freeze shows the cues', lock: 'LOCKED: the hand controller is ignored'};

function draw() {
  document.body.classList.toggle('lost', !clock);
  fill('connection', clock ? 'connected' : state ? 'NO CONNECTION' : 'connecting');
  for (const button of document.querySelectorAll('footer button, #more button, #more input')) button.disabled = !clock;
  if (!state) return;
  const here = state.lists.find((one) => one.name === list);
  document.title = `${here.cue ? here.cue.name : 'dark'} - ${state.show}`;
  fill('show', state.show);
  drawLists();
  const holds = Object.entries(kHolds).filter(([hold]) => state.holds[hold]).map(([, text]) => text);
  if (state.highlight) holds.push(`${state.highlight.solo ? 'SOLO' : 'HIGHLIGHT'} ${state.highlight.lamp}`);
  if (state.master < 1) holds.push(`MASTER ${percent(state.master)}`);
  fill('now-number', here.cue ? here.cue.number : '');
  fill('now-name', here.cue ? here.cue.name : 'no cue yet');
  fill('now-does', here.cue ? here.cue.does : '');
  const entered = state.holds.panic || state.holds.pause ? null : here.go;  // by GO
  const nothing = state.holds.panic ? 'hold Restore first' : state.holds.pause ? 'it goes on after the pause' : 'this is the last cue';
  fill('next-number', entered ? entered.number : '');
  fill('next-name', entered ? entered.name : `nothing: ${nothing}`);
  fill('next-does', entered ? entered.does : '');
  fill('next-note', entered ? entered.note : '');
  for (const hold of Object.keys(kHolds)) $(hold).setAttribute('aria-pressed', state.holds[hold]);
  fill('panic', state.holds.panic ? 'Restore' : 'Panic');
  fill('lock', state.holds.lock ? 'Unlock' : 'Lock');
  if (document.activeElement !== $('master')) $('master').value = Math.round(state.master * 100);
  fill('master-level', percent(state.master));
  for (const one of state.raised) holds.push(`${one.lamp} at least ${percent(one.level)} by hand`);
  for (const one of state.switched) holds.push(`${one.relay} ${one.on ? 'on' : 'off'} by hand`);
  $('holds').replaceChildren(...holds.map(item));
  fill('parked', state.parked.length ? `Parked: ${state.parked.join(', ')}` : '');
  const {unwell, late} = state.health;
  fill('unwell-title', (unwell.length ? `NOT WELL: ${unwell.length}` : 'All is well') + (late ? `, ${late} late ${late === 1 ? 'frame' : 'frames'}` : ''));
  $('unwell').replaceChildren(...unwell.map((one) => item(one.what)));
  markCues(here);
  countDown();
}
const percent = (level) => `${Math.round(level * 100)} %`;
function item(text) {
  const element = document.createElement('li');
  element.textContent = text;
  return element;
}
function drawLists() {
  const names = state.lists.map((one) => one.name);
  $('lists').hidden = names.length < 2;
  if (names.join('\n') !== $('lists').dataset.names) {
    $('lists').dataset.names = names.join('\n');
    $('lists').replaceChildren(...names.map((name) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = name || 'Show';
      button.dataset.list = name;
      button.onclick = () => { list = name; drawCues(); draw(); };
      return button;
    }));
  }
  for (const button of $('lists').children) button.setAttribute('aria-pressed', button.dataset.list === list);
}
function drawCues() {
  const here = cues.lists.find((one) => one.name === list);
  $('cues').replaceChildren(...(here ? here.cues : []).map((cue) => {
    const line = document.createElement('li'), button = document.createElement('button'), number = document.createElement('span');
    button.type = 'button';
    number.className = 'number';
    number.textContent = cue.number;
    button.append(number, cue.name + (cue.note ? ` (${cue.note})` : ''));
    button.onclick = () => choose(cue);
    line.append(button);
    return line;
  }));
  if (state) markCues(state.lists.find((one) => one.name === list));
}
let followed = -1;
function markCues(here) {
  const now = here.cue ? here.cue.index : -1;
  [...$('cues').children].forEach((line, index) => {
    line.classList.toggle('now', index === now);
    line.classList.toggle('next', Boolean(here.go) && index === here.go.index);
    if (index === now) line.firstChild.setAttribute('aria-current', 'step');
    else line.firstChild.removeAttribute('aria-current');
  });
  const line = $('cues').children[now];
  if (now !== followed && line) {
    $('cues').scrollTo({top: line.offsetTop - $('cues').offsetTop - 60});
    followed = now;
  }
}

// Lamps and relays are asked for only while somebody looks at them. A slider that is held is left alone.
let rows = '';
async function drawLights() {
  if (!clock || !$('more').open) return;
  let lights;
  try { lights = await (await fetch('/api/v1/lights')).json(); } catch { return; }
  const names = JSON.stringify([lights.lamps, lights.relays].map((things) => things.map((one) => one.name)));
  if (names !== rows) {
    rows = names;
    $('lamps').replaceChildren(...lights.lamps.map(lampRow));
    $('relays').replaceChildren(...lights.relays.map(relayRow));
  }
  lights.lamps.forEach((lamp, index) => {
    const [label, slider] = $('lamps').children[index].children;
    label.textContent = `${lamp.name}: ${lamp.levels.map(percent).join(' ')}`;
    if (document.activeElement !== slider) slider.value = Math.round(lamp.raised * 100);
  });
  lights.relays.forEach((relay, index) => {
    const button = $('relays').children[index].firstChild;
    button.textContent = `${relay.name}: ${relay.on ? 'on' : 'off'}${relay.by_hand ? ' by hand' : ''}`;
    button.setAttribute('aria-pressed', relay.on);
  });
}
function lampRow(lamp, index) {
  const row = document.createElement('li'), label = document.createElement('label'), slider = document.createElement('input');
  label.htmlFor = slider.id = `lamp-${index}`;
  Object.assign(slider, {type: 'range', min: 0, max: 100, step: 5});
  slider.setAttribute('aria-label', `${lamp.name} by hand, at least`);
  slider.onchange = async () => { await press({do: 'raise', lamp: lamp.name, level: Number(slider.value) / 100}); drawLights(); };
  row.append(label, slider);
  return row;
}
function relayRow(relay) {
  const row = document.createElement('li'), button = document.createElement('button');
  button.type = 'button';
  button.onclick = async () => { await press({do: 'switch', relay: relay.name, on: button.getAttribute('aria-pressed') !== 'true'}); drawLights(); };
  row.append(button);
  return row;
}
$('more').addEventListener('toggle', drawLights);
setInterval(drawLights, 1000);

// Everything that counts down does so here, without asking.
function countDown() {
  if (!state) return;
  const here = state.lists.find((one) => one.name === list);
  const passed = clock && clock.moves ? performance.now() / 1000 - clock.heard : 0;
  const now = clock ? clock.cue + passed : Infinity;
  const left = (moment) => (moment === null ? 0 : Math.max(0, moment - now));
  const waits = left(here.waits_until), fades = left(here.fades_until), follows = left(here.follows_at);
  fill('fade-left', waits ? `begins in ${duration(waits)}` : fades ? `fading ${duration(fades)}` : '');
  $('fade').hidden = !fades || waits > 0;
  if (fades && String(here.fades_until) !== $('fade').dataset.until) { $('fade').dataset.until = here.fades_until; $('fade').max = fades; }
  if (fades) $('fade').value = $('fade').max - fades;
  fill('follow', follows && here.follower ? `${here.follower.name} follows by itself in ${duration(follows)}` : '');
}
setInterval(countDown, 250);

// --- The screen stays awake while the page is seen

async function stayAwake() {
  if (document.visibilityState !== 'visible' || !navigator.wakeLock) return;
  try { await navigator.wakeLock.request('screen'); } catch { /* the battery is low: it may sleep */ }
}
document.addEventListener('visibilitychange', stayAwake);
stayAwake();
connect();
