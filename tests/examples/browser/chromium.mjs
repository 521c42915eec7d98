// Drives headless Chromium through its debugging pipe, with nothing but Node.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export async function openChromium(program) {
  const folder = mkdtempSync(join(tmpdir(), 'tactnet-browser-'));
  const process_ = spawn(program, [
    '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage', '--hide-scrollbars', '--disable-backgrounding-occluded-windows', '--disable-renderer-backgrounding',
    '--disable-background-timer-throttling', '--remote-debugging-pipe', `--user-data-dir=${folder}`, 'about:blank',
  ], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const [, , , to, from] = process_.stdio;
  let number = 0, rest = '';
  const waiting = new Map(), listeners = new Set();
  from.setEncoding('utf8');
  from.on('data', (text) => {
    const messages = (rest + text).split('\0');
    rest = messages.pop();
    for (const message of messages.map((one) => JSON.parse(one))) {
      const asked = waiting.get(message.id);
      waiting.delete(message.id);
      if (asked && message.error) asked.reject(new Error(message.error.message));
      else if (asked) asked.resolve(message.result);
      else listeners.forEach((listener) => listener(message));
    }
  });
  const gone = new Promise((_, reject) => process_.on('exit', (status) => reject(new Error(`Chromium ended with ${status}`))));
  gone.catch(() => {});
  const send = (method, params = {}, sessionId) => Promise.race([gone, new Promise((resolve, reject) => {
    waiting.set(++number, { resolve, reject });
    to.write(JSON.stringify({ id: number, method, params, sessionId }) + '\0');
  })]);

  async function openPage(url, { width = 1440, height = 900, dark = false, touch = false, before = '' } = {}) {
    const { targetId } = await send('Target.createTarget', { url: 'about:blank', newWindow: true });
    const { sessionId } = await send('Target.attachToTarget', { targetId, flatten: true });
    const ask = (method, params) => send(method, params, sessionId);
    const errors = [];
    listeners.add(({ sessionId: of, method, params }) => {
      if (of !== sessionId) return;
      if (method === 'Runtime.exceptionThrown') errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === 'Runtime.consoleAPICalled' && params.type === 'error') errors.push(params.args.map((argument) => argument.value).join(' '));
    });
    await ask('Runtime.enable');
    await ask('Page.enable');
    await ask('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: touch });
    await ask('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
    if (before) await ask('Page.addScriptToEvaluateOnNewDocument', { source: before });
    const evaluate = async (expression) => {
      const { result, exceptionDetails } = await ask('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
      if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
      return result.value;
    };
    // Waits until an expression is true.
    const until = async (expression, seconds = 30) => {
      for (const end = Date.now() + 1000 * seconds; Date.now() < end; await new Promise((done) => setTimeout(done, 50)))
        if (await evaluate(`Boolean(${expression})`).catch(() => false)) return;
      const said = await evaluate(`new Promise((done) => { let frames = 0; const count = () => { ++frames, requestAnimationFrame(count); }; count(); setTimeout(() => done(frames + ' frames in 1 s, ' + (document.hidden ? 'hidden: ' : 'visible: ') + document.body.innerText), 1000); })`);
      throw new Error(`expected within ${seconds} s: ${expression}; the page, ${said}; errors: ${errors.join('; ')}`);
    };
    await ask('Page.navigate', { url });
    await until(`document.readyState === 'complete' && location.href !== 'about:blank'`);
    const mouse = (type, x, y) => ask('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1 });
    const key = async (name) => { await ask('Input.dispatchKeyEvent', { type: 'keyDown', key: name }); await ask('Input.dispatchKeyEvent', { type: 'keyUp', key: name }); };
    const screenshot = async (whole = false) => {
      const { data } = await ask('Page.captureScreenshot', { format: 'png', captureBeyondViewport: whole });
      return Buffer.from(data, 'base64');
    };
    return { ask, errors, evaluate, until, mouse, key, screenshot, close: () => send('Target.closeTarget', { targetId }) };
  }
  const close = async () => {
    await Promise.race([send('Browser.close').catch(() => {}), new Promise((done) => setTimeout(done, 5000))]);
    await Promise.race([gone.catch(() => {}), new Promise((done) => setTimeout(done, 5000))]);
    process_.kill('SIGKILL');
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
  };
  return { openPage, close };
}
