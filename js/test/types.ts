// Compiled, never run: the package as TypeScript sees it.

import { check, ImageTexture, load, read, TextureReader } from 'deepshade';
import { learnedAO } from 'deepshade/three';
import { PerspectiveCamera } from 'three/webgpu';
import { mrt, normalView, pass } from 'three/tsl';
import { Scene } from 'three/webgpu';

export async function frame(
  device: GPUDevice,
  depth: GPUTextureView,
  normal: GPUTextureView,
): Promise<number> {
  const network = await load('shaders/ao', device);
  const { stray } = await check('shaders/ao', network);
  const plan = network.plan(640, 480);
  const encoder = device.createCommandEncoder();
  plan.set({ radius: 0.5, focalLength: 500 });
  const inverseProjection = new Float32Array(16);
  new TextureReader(plan, { normals: 'colour' }).encode(encoder, { depth, normal, inverseProjection });
  plan.encode(encoder);
  new ImageTexture(plan).encode(encoder);
  // @ts-expect-error: a frame has a radius.
  plan.set({ focalLength: 500 });
  return (await read(plan.image, device))[0]! + stray;
}

export async function node(device: GPUDevice): Promise<void> {
  const [scene, camera] = [new Scene(), new PerspectiveCamera()];
  const before = pass(scene, camera);
  before.setMRT(mrt({ output: normalView }));
  const network = await load('shaders/ao', device);
  const ao = learnedAO(before.getTextureNode('depth'), before.getTextureNode(), camera, network);
  ao.radius.value = 0.5;
  ao.dispose();
}
