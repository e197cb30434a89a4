// What is tested and measured in the example with three.js.

import * as THREE from 'three/webgpu';
import { builtinAOContext, mrt, normalView, pass, screenUV } from 'three/tsl';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { learnedAO } from 'deepshade/three';

/** What three.js's node is tried with beside its defaults, so that it is at its best: times the radius. */
const REACHES = [0.5, 0.7, 1, 1.4, 2];
/** Samples a pixel, its default and more. */
const SAMPLES = [16, 64];

/** Frames of which the median is taken. */
const FRAMES = 5;

const shown = () => new Promise(requestAnimationFrame);

async function frame(renderer, pipeline) {
  // Nodes are updated once a frame of the browser's.
  await shown();
  const began = performance.now();
  pipeline.render();
  await renderer.backend.device.queue.onSubmittedWorkDone();
  return performance.now() - began;
}

/** Milliseconds that each of the two nodes adds to a frame, and the mean of the picture that each makes. */
export async function measured() {
  const { renderer, pipeline, theirs, ours } = window.deepshade;
  renderer.setAnimationLoop(() => {});
  const median = async () => {
    const times = [];
    for (let index = 0; index <= FRAMES; index++) times.push(await frame(renderer, pipeline));
    return times.slice(1).sort((a, b) => a - b)[FRAMES >> 1];
  };
  const without = async (node) => {
    const { updateBefore } = node;
    node.updateBefore = () => {};
    const time = await median();
    node.updateBefore = updateBefore;
    return time;
  };
  const whole = await median();
  const [noGtao, noLearned] = [await without(theirs), await without(ours)];
  const figures = {
    ms_browser_three_gtao: whole - noGtao,
    ms_browser_three_learned: whole - noLearned,
    mean_gtao: await mean(0),
    mean_learned: await mean(1),
  };
  const { width, height } = renderer.domElement;
  renderer.setSize(Math.ceil(0.6 * width), Math.ceil(0.7 * height));
  return { ...figures, mean_learned_resized: await mean(1) };
}

/** The example's model and camera as a glTF file's text, so that truth can be rendered of the same frame. */
export async function exported() {
  const { model, camera } = window.deepshade;
  const scene = new THREE.Scene();
  scene.add(model.clone(), camera.clone());
  return JSON.stringify(await new GLTFExporter().parseAsync(scene, { onlyVisible: false }));
}

/**
 * How like truth the occlusion is that each of the two nodes makes for a radius, by structural similarity:
 * three.js's with its defaults and at its best; so is a picture that deepshade's program made of the frame,
 * which says whether similarity is here what it is there, and how like that our node's is. `truth` and
 * `picture` are addresses of PNG files.
 */
export async function besideTruth(radius, truth, picture) {
  const { renderer, theirs, ours } = window.deepshade;
  renderer.setAnimationLoop(() => {});
  const { width, height } = renderer.domElement;
  const read = (address) => fetched(address, width, height);
  const [wanted, made] = [await read(truth), await read(picture)];
  const score = async (which) => similarity(await opennessOf(which), wanted, width);
  ours.radius.value = theirs.radius.value = radius;
  const figures = {
    ssim_picture: similarity(made, wanted, width),
    ssim_own: similarity(await opennessOf(1), made, width),
    ssim_learned: await score(1),
  };
  const tried = [];
  for (const samples of SAMPLES)
    for (const reach of REACHES) {
      theirs.samples.value = samples;
      theirs.radius.value = reach * radius;
      tried.push({ samples, reach, ssim: await score(0) });
    }
  const usual = tried.find(({ samples, reach }) => samples === SAMPLES[0] && reach === 1);
  const best = tried.reduce((a, b) => (b.ssim > a.ssim ? b : a));
  theirs.samples.value = SAMPLES[0];
  theirs.radius.value = radius;
  return { ...figures, ssim_gtao: usual.ssim, ssim_gtao_best: best.ssim, best };
}

/** Structural similarity of images of openness, row by row, in tiles of 8 x 8, as deepshade measures it. */
function similarity(a, b, width) {
  const [tile, c1, c2] = [8, 1e-4, 9e-4];
  const height = a.length / width;
  let [sum, count] = [0, 0];
  for (let y = 0; y + tile <= height; y += tile)
    for (let x = 0; x + tile <= width; x += tile) {
      const sums = { a: 0, b: 0, aa: 0, bb: 0, ab: 0 };
      for (let pixel = 0; pixel < tile * tile; pixel++) {
        const at = (y + Math.floor(pixel / tile)) * width + x + (pixel % tile);
        sums.a += a[at];
        sums.b += b[at];
        sums.aa += a[at] * a[at];
        sums.bb += b[at] * b[at];
        sums.ab += a[at] * b[at];
      }
      const [mean, means] = [sums.a / tile ** 2, sums.b / tile ** 2];
      const of = (squares, product) => squares / tile ** 2 - product;
      const [va, vb] = [of(sums.aa, mean * mean), of(sums.bb, means * means)];
      const vab = of(sums.ab, mean * means);
      const least = (mean ** 2 + means ** 2 + c1) * (va + vb + c2);
      sum += ((2 * mean * means + c1) * (2 * vab + c2)) / least;
      count += 1;
    }
  return sum / count;
}

/** The mean of the canvas, 0 to 1, where occlusion alone is shown, of three.js at 0 and of deepshade at 1. */
async function mean(which) {
  return whereAlone(which, meanOf);
}

/** Openness of every pixel, of three.js at 0 and of deepshade at 1. */
async function opennessOf(which) {
  return whereAlone(which, (canvas) => opennessIn(canvas, canvas.width, canvas.height));
}

/** What is read of the canvas where occlusion alone is shown, of three.js at 0 and of deepshade at 1. */
async function whereAlone(which, read) {
  const { renderer, pipeline } = window.deepshade;
  const set = (id, event, change) => {
    change(document.getElementById(id));
    document.getElementById(id).dispatchEvent(new Event(event));
  };
  const radii = [window.deepshade.theirs, window.deepshade.ours].map(({ radius }) => [radius, radius.value]);
  set('wipe', 'input', (wipe) => (wipe.value = 1 - which));
  set('alone', 'change', (alone) => (alone.checked = true));
  // The page's sliders set radii.
  radii.forEach(([radius, value]) => (radius.value = value));
  for (let index = 0; index < 2; index++) await frame(renderer, pipeline);
  pipeline.render();
  const found = read(renderer.domElement);
  set('alone', 'change', (alone) => (alone.checked = false));
  set('wipe', 'input', (wipe) => (wipe.value = 0.5));
  radii.forEach(([radius, value]) => (radius.value = value));
  return found;
}

async function fetched(address, width, height) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  return opennessIn(await createImageBitmap(await response.blob()), width, height);
}

/** A picture's values, which are encoded as sRGB. */
function opennessIn(picture, width, height) {
  const data = pixels(picture, width, height);
  const linear = (code) => (code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4);
  return Float64Array.from({ length: width * height }, (_, index) => linear(data[4 * index] / 255));
}

function pixels(picture, width, height) {
  const context = new OffscreenCanvas(width, height).getContext('2d');
  context.drawImage(picture, 0, 0);
  return context.getImageData(0, 0, width, height).data;
}

function meanOf(canvas) {
  const { width, height } = canvas;
  const data = pixels(canvas, width, height);
  let sum = 0;
  for (let index = 0; index < data.length; index += 4) sum += data[index] / 255;
  return sum / (width * height);
}

/** The README's lines, without any other node beside: how much darker the picture is for them. */
export async function alone() {
  const { renderer, ours } = window.deepshade;
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0xffffff, 3));
  const material = new THREE.MeshStandardMaterial({ side: THREE.BackSide });
  scene.add(new THREE.Mesh(new THREE.BoxGeometry(4, 3, 4), material));
  const camera = new THREE.PerspectiveCamera(60, 4 / 3, 0.1, 10);
  camera.position.z = 1.5;

  const before = pass(scene, camera, { samples: 0 });
  before.setMRT(mrt({ output: normalView }));
  const aoPass = learnedAO(before.getTextureNode('depth'), before.getTextureNode(), camera, ours.network);
  aoPass.radius.value = 0.5;
  const scenePass = pass(scene, camera);
  scenePass.contextNode = builtinAOContext(aoPass.getTextureNode().sample(screenUV).r);

  const pipeline = new THREE.RenderPipeline(renderer);
  const means = [];
  for (const output of [pass(scene, camera), scenePass]) {
    pipeline.outputNode = output;
    pipeline.needsUpdate = true;
    for (let index = 0; index < 2; index++) await frame(renderer, pipeline);
    pipeline.render();
    means.push(meanOf(renderer.domElement));
  }
  aoPass.dispose();
  return means[0] - means[1];
}
