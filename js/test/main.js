// Checks networks against the frames that were exported with them, and times one of them beside
// onnxruntime-web on the same device. Parameters of the address: `networks`, folders with commas between
// them; `onnx`, the ONNX file of the last; `width`, `height` of what is timed.

import { check, load } from '../deepshade.js';
import * as ort from 'onnxruntime-web/webgpu';

const wanted = new URLSearchParams(location.search);
const [width, height] = ['width', 'height'].map((name) => Number(wanted.get(name) ?? 256));
/** Repetitions of which the median is taken. */
const REPEATS = 5;

async function main() {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('this browser has no WebGPU');
  const limits = ['maxStorageBufferBindingSize', 'maxBufferSize'];
  const device = await adapter.requestDevice({
    requiredLimits: Object.fromEntries(limits.map((name) => [name, adapter.limits[name]])),
  });
  const refused = [];
  device.addEventListener('uncapturederror', ({ error }) => refused.push(error.message));
  const figures = {};
  let network;
  for (const folder of wanted.get('networks').split(',')) {
    network = await load(folder, device);
    const { largest, stray } = await check(folder, network);
    const name = folder.split('/').pop();
    Object.assign(figures, { [`max_abs_${name}`]: largest, [`stray_${name}`]: stray });
  }
  figures.ms_browser_learned = await timed(() => ours(network, device));
  if (wanted.has('onnx')) {
    const session = await ort.InferenceSession.create(wanted.get('onnx'), { executionProviders: ['webgpu'] });
    const channels = network.description.buffers.input.made[0].planes;
    const input = new ort.Tensor('float32', new Float32Array(channels * width * height), [
      1,
      channels,
      height,
      width,
    ]);
    figures.ms_browser_onnxruntime = await timed(() => session.run({ [session.inputNames[0]]: input }));
  }
  if (refused.length > 0) throw new Error(refused[0]);
  return figures;
}

let plan;
async function ours(network, device) {
  plan ??= network.plan(width, height);
  plan.set({ radius: 0.5, focalLength: height });
  const encoder = device.createCommandEncoder();
  plan.encode(encoder);
  device.queue.submit([encoder.finish()]);
  await device.queue.onSubmittedWorkDone();
}

/** Milliseconds until it is done, the median after a first time that is not counted. */
async function timed(work) {
  await work();
  const times = [];
  for (let repeat = 0; repeat < REPEATS; repeat++) {
    const began = performance.now();
    await work();
    times.push(performance.now() - began);
  }
  return times.sort((a, b) => a - b)[REPEATS >> 1];
}

main().then(
  (figures) => (document.body.dataset.figures = JSON.stringify(figures)),
  (error) => (document.body.dataset.failed = error.stack ?? String(error)),
);
