// What is tested and measured in the example with three.js.

import * as THREE from 'three/webgpu';
import { builtinAOContext, mrt, normalView, pass, screenUV } from 'three/tsl';
import { learnedAO } from 'deepshade/three';

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

/** The mean of the canvas, 0 to 1, where occlusion alone is shown, of three.js at 0 and of deepshade at 1. */
async function mean(which) {
  const { renderer, pipeline } = window.deepshade;
  const set = (id, event, change) => {
    change(document.getElementById(id));
    document.getElementById(id).dispatchEvent(new Event(event));
  };
  set('wipe', 'input', (wipe) => (wipe.value = 1 - which));
  set('alone', 'change', (alone) => (alone.checked = true));
  for (let index = 0; index < 2; index++) await frame(renderer, pipeline);
  pipeline.render();
  const found = meanOf(renderer.domElement);
  set('alone', 'change', (alone) => (alone.checked = false));
  set('wipe', 'input', (wipe) => (wipe.value = 0.5));
  return found;
}

function meanOf(canvas) {
  const { width, height } = canvas;
  const context = new OffscreenCanvas(width, height).getContext('2d');
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
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
