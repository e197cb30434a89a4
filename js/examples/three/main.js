// A scene under a sky with ambient occlusion of three.js on the left of a border and of deepshade on the
// right. Parameters of the address: `network`, the folder of a network's files; `scene`, a glTF file;
// `width`, `height`.

import * as THREE from 'three/webgpu';
import {
  builtinAOContext,
  float,
  mix,
  mrt,
  normalView,
  pass,
  screenUV,
  step,
  uniform,
  vec4,
} from 'three/tsl';
import { ao } from 'three/addons/tsl/display/GTAONode.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { load } from 'deepshade';
import { learnedAO } from 'deepshade/three';

const wanted = new URLSearchParams(location.search);
const number = (name, otherwise) => Number(wanted.get(name) ?? otherwise);
const [width, height] = [number('width', 960), number('height', 640)];
const element = (id) => document.getElementById(id);

async function main() {
  // Frames of a full screen need larger buffers than devices allow unasked.
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('this browser has no WebGPU');
  const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
  const requiredLimits = { maxStorageBufferBindingSize, maxBufferSize };
  const renderer = new THREE.WebGPURenderer({ antialias: false, requiredLimits });
  renderer.setSize(width, height);
  await renderer.init();
  element('view').prepend(renderer.domElement);

  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0.55, 0.65, 0.8);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x998877, 3));
  const camera = new THREE.PerspectiveCamera(50, width / height, 0.05, 100);
  camera.position.set(2.6, 2.2, 3.4);
  const model = wanted.has('scene') ? await modelOf(wanted.get('scene')) : things();
  scene.add(model);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.set(0, 0.5, 0);
  controls.update();

  const before = pass(scene, camera, { samples: 0 });
  before.setMRT(mrt({ output: normalView }));
  const [normal, depth] = [before.getTextureNode(), before.getTextureNode('depth')];
  const theirs = ao(depth, normal, camera);
  const network = await load(wanted.get('network') ?? '../../shaders/ao', renderer.backend.device);
  const ours = learnedAO(depth, normal, camera, network);
  const border = uniform(0.5);
  const right = step(border, screenUV.x);
  const openness = mix(
    theirs.getTextureNode().sample(screenUV).r,
    ours.getTextureNode().sample(screenUV).r,
    right,
  );
  const lit = pass(scene, camera, { samples: 0 });
  lit.contextNode = builtinAOContext(openness);

  const pipeline = new THREE.RenderPipeline(renderer);
  const show = () => {
    pipeline.outputNode = element('alone').checked ? vec4(openness, openness, openness, float(1)) : lit;
    pipeline.needsUpdate = true;
  };
  show();
  element('alone').addEventListener('change', show);
  const slide = () => {
    border.value = Number(element('wipe').value);
    element('border').style.left = `${border.value * width}px`;
    theirs.radius.value = ours.radius.value = Number(element('radius').value);
  };
  slide();
  element('wipe').addEventListener('input', slide);
  element('radius').addEventListener('input', slide);

  let frames = 0;
  renderer.setAnimationLoop(() => {
    pipeline.render();
    frames += 1;
    document.body.dataset.frames = String(frames);
  });
  Object.assign(window, { deepshade: { renderer, theirs, ours, pipeline, model, camera } });
}

/** A glTF file in the middle, two metres large. */
async function modelOf(url) {
  const { scene } = await new GLTFLoader().loadAsync(url);
  const box = new THREE.Box3().setFromObject(scene);
  const scale = 2 / Math.max(...box.getSize(new THREE.Vector3()).toArray());
  scene.scale.setScalar(scale);
  scene.position.copy(box.getCenter(new THREE.Vector3()).multiplyScalar(-scale)).setY(-box.min.y * scale);
  return scene;
}

/** Things on a floor before two walls. */
function things() {
  const group = new THREE.Group();
  const material = new THREE.MeshStandardMaterial({ color: 0xe8e4de, roughness: 0.9 });
  const put = (geometry, x, y, z) => {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.position.set(x, y, z);
    group.add(mesh);
    return mesh;
  };
  put(new THREE.BoxGeometry(5, 0.1, 5), 0, -0.05, 0);
  put(new THREE.BoxGeometry(5, 3, 0.1), 0, 1.5, -1.6);
  put(new THREE.BoxGeometry(0.1, 3, 5), -1.9, 1.5, 0);
  put(new THREE.BoxGeometry(0.9, 0.9, 0.9), -0.9, 0.45, -0.8).rotation.y = 0.5;
  put(new THREE.SphereGeometry(0.45, 48, 24), 0.3, 0.45, -0.2);
  put(new THREE.TorusKnotGeometry(0.35, 0.12, 160, 24), 1.1, 0.6, 0.4);
  put(new THREE.CylinderGeometry(0.2, 0.2, 1.4, 32), -1.4, 0.7, 0.6);
  for (let i = 0; i < 6; i++)
    put(new THREE.BoxGeometry(0.16, 0.2 + 0.1 * i, 0.5), -0.7 + 0.2 * i, 0.1 + 0.05 * i, 1.2);
  return group;
}

main().catch((error) => {
  element('said').textContent = error.message;
  document.body.dataset.failed = error.message;
  console.error(error);
});
