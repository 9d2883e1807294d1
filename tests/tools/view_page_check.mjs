// Plays a replay page in Chromium and fails on any error. Not part of the tests, which need no browser:
//   node tests/tools/view_page_check.mjs view.html [picture.png]
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [page, picture] = process.argv.slice(2);
if (!page) {
  console.error('usage: node view_page_check.mjs view.html [picture.png]');
  process.exit(2);
}
const profile = mkdtempSync(join(tmpdir(), 'view-page-check-'));
const browser = spawn('chromium', [
  '--headless', '--no-sandbox', '--disable-gpu', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--remote-debugging-pipe', '--window-size=1400,900',
  `--user-data-dir=${profile}`,
], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});

// The DevTools protocol: JSON messages that end in NUL, over file descriptors 3 and 4.
const pending = new Map(), errors = [];
let lastId = 0, buffer = '', session;
browser.stdio[4].on('data', (data) => {
  const messages = (buffer + data).split('\0');
  buffer = messages.pop();
  for (const message of messages.map((text) => JSON.parse(text))) {
    if (message.id) pending.get(message.id)(message);
    const {method, params} = message;
    if (method === 'Runtime.exceptionThrown') errors.push(params.exceptionDetails.exception.description);
    if (method === 'Log.entryAdded') errors.push(params.entry.text);
  }
});
async function send(method, params = {}) {
  const id = ++lastId;
  browser.stdio[3].write(JSON.stringify({id, method, params, sessionId: session}) + '\0');
  const {result, error} = await new Promise((done) => pending.set(id, done));
  if (error) throw new Error(`${method}: ${error.message}`);
  return result;
}
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
async function value(expression) {
  return (await send('Runtime.evaluate', {expression, returnByValue: true})).result.value;
}
async function key(name) {
  const text = name.length === 1 ? name : undefined;
  await send('Input.dispatchKeyEvent', {type: 'keyDown', key: name, text});
  await send('Input.dispatchKeyEvent', {type: 'keyUp', key: name});
  await sleep(50);
}
async function mouse(type, x, y) {
  await send('Input.dispatchMouseEvent', {type, x, y, button: 'left', buttons: 1, clickCount: 1});
}
function expect(condition, what) {
  console.log(`${condition ? 'ok  ' : 'FAIL'} ${what}`);
  if (!condition) errors.push(what);
}

try {
  const {targetId} = await send('Target.createTarget', {url: 'about:blank'});
  session = (await send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
  for (const domain of ['Runtime', 'Log', 'Page']) await send(`${domain}.enable`);
  await send('Page.navigate', {url: pathToFileURL(resolve(page)).href});
  for (let i = 0; i < 200 && !(await value('!!window.mvtp')); ++i) await sleep(50);
  expect(await value('!!window.mvtp'), 'the replay is unpacked');
  await sleep(300);

  await key('End');
  expect(await value('mvtp.time === mvtp.end'), 'End goes to the end');
  await key('Home');
  await key('ArrowRight');
  expect(await value('mvtp.time > mvtp.begin || mvtp.end === mvtp.begin'), 'an arrow steps one frame');
  await key(' ');
  await sleep(400);
  await key(' ');
  expect(await value('!mvtp.playing'), 'Space plays and pauses');

  const scale = 'mvtp.panes[0].painter.camera.scale', x = 'mvtp.panes[0].painter.camera.x';
  const [scaleBefore, xBefore] = [await value(scale), await value(x)];
  await key('z');
  expect(await value(scale) > scaleBefore, 'Z zooms in');
  await mouse('mousePressed', 300, 400);
  for (let i = 1; i <= 5; ++i) await mouse('mouseMoved', 300 + 20 * i, 400);
  await mouse('mouseReleased', 400, 400);
  expect(await value(x) < xBefore, 'dragging moves the view');
  await key('f');

  const id = await value('mvtp.replays[0].vehicles[0]?.id');
  if (id !== undefined) {
    await value(`mvtp.select(${JSON.stringify(id)}, true)`);
    await sleep(400);
    const address = await value('new URLSearchParams(location.hash.slice(1)).get("sel")');
    expect(address === id, 'the address keeps the selected vehicle');
  }
  if (picture) {
    const {data} = await send('Page.captureScreenshot', {format: 'png'});
    writeFileSync(picture, Buffer.from(data, 'base64'));
  }
  expect(errors.length === 0, 'no errors in the page');
} catch (error) {
  errors.push(error.message);
}
browser.kill();
await sleep(500);
rmSync(profile, {recursive: true, force: true, maxRetries: 5, retryDelay: 200});
for (const error of errors) console.error(error);
process.exit(errors.length ? 1 : 0);
