// SPDX-License-Identifier: MIT
// Used by scripts/peers: node peers.mjs PROGRAM FOLDER SCENE.glb... FOLDER has the npm packages, this file, browser.mjs
// and peers_three.html.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

import {browse, openPage, serve} from './browser.mjs';

const [program, folder, ...scenes] = process.argv.slice(2);
const rounds = 5;
// Pictures that are timed in a round, after one that is not.
const pictures = {1: 9, 16: 3, 64: 1};

const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

/** Milliseconds of each picture, and their RMSE. */
function gnomon(scene, reference, [width, height], samples, shadows) {
  const picture = path.join(folder, `${path.parse(scene).name}-${samples}.exr`);
  const json = path.join(folder, 'run.json');
  execFileSync(program, ['render', scene, '-o', picture, '--size', `${width}x${height}`, '--samples', String(samples),
                         '--repeat', String(pictures[samples] + 1), '--json', json,
                         ...(shadows === 'redrawn' ? ['--redraw-shadows'] : [])]);
  const {frame_seconds: seconds} = JSON.parse(fs.readFileSync(json));
  execFileSync(program, ['compare', picture, reference, '--json', json]);
  return {times: seconds.slice(1).map((one) => 1000 * one), error: JSON.parse(fs.readFileSync(json)).rmse};
}

async function three(page, samples, shadows) {
  const times = [];
  for (let count = 0; count <= pictures[samples]; count++) {
    times.push(await page.evaluate((...values) => window.show.time(...values), samples, shadows));
  }
  return times.slice(1);
}

const folders = scenes.map((scene, index) => [`/scene${index}/`, path.dirname(scene)]);
const server = await serve(Object.fromEntries([...folders, ['/', folder]]));
const browser = await browse('llvmpipe');
for (const [index, scene] of scenes.entries()) {
  const {name, dir} = path.parse(scene);
  const reference = fs.readdirSync(dir).find((one) => one.startsWith(`${name}.cycles-`) && one.endsWith('.exr'));
  if (reference === undefined) {
    console.error(`scripts/peers: ${scene}: no ${name}.cycles-SPP.exr beside it`);
    process.exit(1);
  }
  const page = await openPage(browser, `${server.origin}/peers_three.html`);
  const urls = [path.basename(scene), reference].map((file) => `/scene${index}/${file}`);
  const {note, size} = await page.evaluate((...values) => window.show.load(...values), ...urls);
  console.log(`\n${name}: ${note}`);
  console.log(`medians of ${rounds} rounds, ms`.padEnd(19) + 'three.js       RMSE       gnomon       RMSE      ratio    least     most');
  for (const samples of [1, 16, 64]) {
    for (const shadows of ['kept', 'redrawn']) {
      const [theirs, ours, ratios] = [[], [], []];
      let error;
      for (let round = 0; round < rounds; round++) {
        theirs.push(median(await three(page, samples, shadows)));
        const picture = gnomon(scene, path.join(dir, reference), size, samples, shadows);
        ours.push(median(picture.times));
        error = picture.error;
        ratios.push(ours[round] / theirs[round]);
      }
      const theirError = await page.evaluate((count) => window.show.error(count), samples);
      const cells = [[median(theirs), 1, 12], [theirError, 5, 10], [median(ours), 1, 12], [error, 5, 10], [median(ratios), 2, 10],
                     [Math.min(...ratios), 2, 8], [Math.max(...ratios), 2, 8]];
      const texts = cells.map(([value, digits, room]) => value.toFixed(digits).padStart(room));
      console.log(`${samples} ${shadows}`.padEnd(15) + texts.join(' '));
    }
  }
  await page.close();
}
await browser.close();
server.close();
