// SPDX-License-Identifier: MIT
// Pages of three.js in Debian's Chromium, for scripts/models and scripts/peers.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';

import {launch} from 'puppeteer-core';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png'};

/**
 * Serves folders on a free local port until close(). folders: their paths by URL prefixes, the longest first.
 * Returns {origin, close}.
 */
export async function serve(folders) {
  const server = http.createServer((request, response) => {
    const url = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    const prefix = Object.keys(folders).find((one) => url.startsWith(one));
    const file = path.join(folders[prefix], url.slice(prefix.length));
    fs.readFile(file, (error, bytes) => {
      response.writeHead(error ? 404 : 200, {'content-type': types[path.extname(file)] ?? 'application/octet-stream'});
      response.end(bytes);
    });
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return {origin: `http://127.0.0.1:${server.address().port}`, close: () => server.close()};
}

/** A headless browser without network requests of its own. rasteriser: 'swiftshader', or 'llvmpipe', which is Mesa's. */
export function browse(rasteriser) {
  const flags = {
    swiftshader: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    llvmpipe: ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
  };
  return launch({
    executablePath: '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-background-networking', ...flags[rasteriser]],
    env: {...process.env, LIBGL_ALWAYS_SOFTWARE: '1'},
    protocolTimeout: 600000,
  });
}

/** A page of a served file after its script has set window.show. Messages of its console go to stderr. */
export async function openPage(browser, url) {
  const page = await browser.newPage();
  page.on('console', (message) => console.error(`three.js: ${message.text()}`));
  page.on('pageerror', (error) => console.error(`three.js: ${error.message}`));
  await page.goto(url);
  await page.waitForFunction('window.show');
  return page;
}
