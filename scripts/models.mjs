// SPDX-License-Identifier: MIT
// Used by scripts/models: node models.mjs PROGRAM FOLDER SHEETS. FOLDER has the npm packages, this file, browser.mjs and models_three.html.
import {execFile} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {promisify} from 'node:util';

import validator from 'gltf-validator';

import {browse, openPage, serve} from './browser.mjs';

const [program, folder, sheets] = process.argv.slice(2);
const debian = '/usr/share/assimp/models';
const profiles = path.join(folder, 'node_modules/@webxr-input-profiles/assets/dist/profiles');
const width = 256;

/** The validator's error codes of a file, separated by blanks. */
async function errors(file) {
  const read = (uri) => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri))).then((bytes) => new Uint8Array(bytes));
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {externalResourceFunction: read});
  return [...new Set(report.issues.messages.filter((issue) => issue.severity === 0).map((issue) => issue.code))].join(' ');
}

/** Models of the package that are valid and have a mesh, and two that differ from valid ones by one detail. */
async function debianModels() {
  const models = [];
  for (const name of fs.readdirSync(path.join(debian, 'glTF2'), {recursive: true}).sort()) {
    const file = path.join(debian, 'glTF2', name);
    if (!/\.gl(tf|b)$/.test(name) || name.endsWith('SceneWithoutNodes.gltf')) {
      continue;
    }
    const faults = await errors(file).catch((error) => String(error));
    if (faults === '' || /ClearCoatTest|texcoord_crash/.test(name)) {
      models.push({name: name.replace(/^glTF-[^/]*\/|\.gl(tf|b)$/g, ''), file});
    }
  }
  // Poses that the rest shapes do not show.
  for (const part of ['AnimatedMorphCube', 'simple_skin']) {
    const model = models.find((one) => one.name.includes(part));
    models.push({name: `${model.name}, 1 s`, file: model.file, seconds: 1});
  }
  return models;
}

async function npmModels() {
  const models = ['generic-hand/right', 'generic-trigger/none', 'htc-vive-cosmos/left', 'htc-vive-focus-plus/none', 'magicleap-one/none', 'magicleap-two/none',
                  'microsoft-mixed-reality/left', 'oculus-go/none', 'pico-4u/left', 'samsung-galaxyxr/left', 'valve-index/left', 'generic-fixed-hand/left']
                     .map((name) => ({name, file: path.join(profiles, `${name}.glb`)}));
  for (const name of ['bunny', 'pmndrs', 'suzi']) {
    const {default : uri} = await import(path.join(folder, 'node_modules/@pmndrs/assets/models', `${name}.glb.js`));
    const file = path.join(folder, `${name}.glb`);
    fs.writeFileSync(file, Buffer.from(uri.slice(uri.indexOf(',') + 1), 'base64'));
    models.push({name, file});
  }
  return models;
}

/** Adds the picture, and the bounds, for which both viewers place the same camera. */
async function render(model, index) {
  const run = promisify(execFile);
  const picture = path.join(folder, `gnomon${index}.png`);
  const json = path.join(folder, 'run.json');
  const frame = model.seconds === undefined ? [] : ['--frames', String(24 * model.seconds)];
  const {stdout} = await run(program, ['info', model.file]);
  const bounds = stdout.match(/bounds \(([^)]*)\) to \(([^)]*)\)/);
  model.bounds = bounds.slice(1).map((corner) => corner.split(',').map(Number));
  await run(program, ['render', model.file, '-o', picture, '--json', json, '--size', `${width}x${width}`, ...frame], {maxBuffer: 1 << 26});
  const report = JSON.parse(fs.readFileSync(json));
  const nonFinite = report.non_finite ?? report.frames?.reduce((sum, one) => sum + one.non_finite, 0);
  if (nonFinite !== 0) {
    throw new Error(`${nonFinite} values are not finite`);
  }
  model.gnomon = '/' + path.basename(picture);
}

const server = await serve({'/debian/': debian, '/': folder});
const browser = await browse('swiftshader');
let failures = 0;

async function sheet(models, name) {
  const page = await openPage(browser, `${server.origin}/models_three.html`);
  for (const [index, model] of models.entries()) {
    process.stderr.write(`${model.name}\n`);
    try {
      await render(model, `_${name}_${index}`);
    } catch (error) {
      failures++;
      process.stderr.write(`gnomon: ${error.stderr ?? error.message}\n`);
    }
    try {
      const url = model.file.startsWith(debian) ? '/debian' + model.file.slice(debian.length) : model.file.slice(folder.length);
      model.three = await page.evaluate((...values) => window.show(...values), url, model.bounds, width, model.seconds);
    } catch (error) {
      process.stderr.write(`three.js: ${error.message}\n`);
    }
  }
  const figures = models.map(({name, gnomon, three}) => `<figure><img src="${gnomon ?? ''}"><img src="${three ?? ''}"><figcaption>${name}</figcaption></figure>`);
  await page.goto(`${server.origin}/models_three.html?sheet`);
  await page.setViewport({width: 6 * width + 30, height: 400});
  await page.evaluate((html) => {
    document.body.innerHTML = html;
    return Promise.all([...document.images].map((image) => image.decode().catch(() => {})));
  }, `<style>body{margin:4px;font:13px sans-serif;display:grid;grid-template-columns:repeat(3,1fr);gap:8px}figure{margin:0}img{width:${width}px;height:${width}px}</style>` +
     figures.join(''));
  await page.screenshot({path: path.join(sheets, `models_${name}.jpg`), fullPage: true, type: 'jpeg', quality: 85});
  await page.close();
}

const scenes = fs.readdirSync(path.join(folder, 'scenes')).sort().map((name) => ({name: path.parse(name).name, file: path.join(folder, 'scenes', name)}));
await sheet(await debianModels(), 'debian');
await sheet(await npmModels(), 'npm');
await sheet(scenes, 'tests');
await browser.close();
server.close();
process.exitCode = failures > 0 ? 1 : 0;
