#!/usr/bin/env node
// bench/page.mjs PROGRAM [PRESSES [LISTENERS]]: a show in real time on two outputs of 320x180 at 30 Hz, and
// presses of GO by HTTP. Prints how long an answer takes, and how long it takes from sending a press to
// the first frame with another picture; late frames, and the share of a core that the program takes,
// first without and then with so many pages that listen (default: 150 presses, 50 pages). The clocks of
// the show and of this program differ by a constant: the press that arrived soonest counts as no time
// at all.

import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import http from 'node:http';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const [program, presses = '150', listeners = '50'] = process.argv.slice(2);
const kRate = 30, kClockTicks = 100;  // Hz; a second of /proc
const show = join(dirname(fileURLToPath(import.meta.url)), 'red-and-blue');
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const percentile = (sorted, share) => sorted[Math.floor(share * (sorted.length - 1))];
function print(what, milliseconds) {
  const sorted = [...milliseconds].sort((a, b) => a - b);
  console.log(`  ${what.padEnd(18)} p50 ${percentile(sorted, 0.5).toFixed(2)}  p99 ${percentile(sorted, 0.99).toFixed(2)}  max ${sorted.at(-1).toFixed(2)} ms, ${sorted.length}`);
}
function cpuOf(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / kClockTicks;
}

async function measure(pages) {
  const folder = mkdtempSync(join(tmpdir(), 'page-bench-'));
  const run = spawn(resolve(program), ['run', show, '--site', show, '--journal', '.', '--record', 'seen', '--report', 'report.json', '--console', 'localhost:0'],
    {cwd: folder, stdio: ['ignore', 'ignore', 'pipe']});
  let said = '';
  run.stderr.on('data', (text) => { said += text; });
  let isOver = false;
  const ended = new Promise((done) => run.on('close', () => { isOver = true; done(); }));
  while (!isOver && !/http:\/\/localhost:(\d+)/.test(said)) await sleep(20);
  if (isOver) throw new Error(`it does not begin: ${said}`);
  const port = Number(/http:\/\/localhost:(\d+)/.exec(said)[1]);
  const agent = new http.Agent({keepAlive: true, maxSockets: 1});
  const post = (body) => new Promise((done, failed) => {
    const request = http.request({port, agent, method: 'POST', path: '/api/v1/inputs', headers: {'Content-Type': 'application/json', 'Content-Length': body.length}},
      (answer) => { answer.resume(); answer.on('end', done); });
    request.on('error', failed);
    request.end(body);
  });
  let bytes = 0;
  const open = [];
  for (let i = 0; i < pages; ++i)
    open.push(http.get({port, path: '/api/v1/events', agent: new http.Agent()}, (answer) => answer.on('data', (chunk) => { bytes += chunk.length; })));
  for (const one of open) one.on('error', () => {});
  await sleep(3000);
  const cpu = cpuOf(run.pid), began = performance.now();
  const answers = [], pressed = [];
  for (let press = 0; press < Number(presses); ++press) {
    await sleep(307);  // so they fall on all phases of a period
    const start = performance.now();
    pressed.push(start / 1e3);
    await post('{"do":"go"}');
    answers.push(performance.now() - start);
  }
  const share = 100 * (cpuOf(run.pid) - cpu) / ((performance.now() - began) / 1e3);
  await sleep(1000);
  for (const one of open) one.destroy();
  agent.destroy();
  run.kill('SIGINT');
  await ended;
  const taken = readFileSync(join(folder, 'journal'), 'utf8').split('\n').map((line) => line.split(' '))
    .filter((words) => words[1] === 'input' && words[3] === 'go').map((words) => Number(words[2]) / 1e9);
  const changed = [];
  let before = null;
  for (const line of readFileSync(join(folder, 'seen/frames.csv'), 'utf8').split('\n').slice(1)) {
    const fields = line.split(',');
    if (fields[2] !== 'left') continue;
    if (before !== null && fields[3] !== before) changed.push(Number(fields[1]));
    before = fields[3];
  }
  const report = JSON.parse(readFileSync(join(folder, 'report.json'), 'utf8'));
  rmSync(folder, {recursive: true});
  if (taken.length !== pressed.length) throw new Error(`${pressed.length} presses, ${taken.length} taken:\n${said}`);
  const offset = Math.min(...taken.map((time, i) => time - pressed[i]));
  const seen = pressed.map((press) => 1e3 * (changed.find((time) => time > press + offset) - press - offset));
  console.log(`${pages} pages that listen:`);
  print('press to answer', answers);
  print('press to frame', seen);
  console.log(`  ${report.late_frames} of ${report.frames} frames late, ${share.toFixed(1)} % of a core, ${(bytes / 1e3).toFixed(0)} kB pushed`);
}

await measure(0);
await measure(Number(listeners));
console.log(`wanted, p99: answer 20 ms, frame ${(1500 / kRate + 25).toFixed(0)} ms`);
