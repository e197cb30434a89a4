// Ambient occlusion by a network of deepshade as a node of three.js, in the place of its GTAONode:
//
//   const network = await load('shaders/ao', renderer.backend.device);
//   const aoPass = learnedAO(prePassDepth, prePassNormal, camera, network);
//   scenePass.contextNode = builtinAOContext(aoPass.getTextureNode().sample(screenUV).r);

import { ImageTexture, TextureReader } from './deepshade.js';
import { ExternalTexture, Node, NodeUpdateType } from 'three/webgpu';
import { passTexture, uniform } from 'three/tsl';

/** A node whose texture has ambient occlusion that a network makes of depth and normals. */
export class LearnedAONode extends Node {
  static get type() {
    return 'LearnedAONode';
  }

  /**
   * `depthNode` and `normalNode` are the textures of a pass without multisampling, normals by `normalView`.
   * `network` is what `load` gives.
   */
  constructor(depthNode, normalNode, camera, network) {
    super('float');
    if (network.effect !== 'ao') throw new Error(`learnedAO wants a network of ao, not of ${network.effect}`);
    Object.assign(this, { depthNode, normalNode, camera, network });
    this.updateBeforeType = NodeUpdateType.FRAME;
    /** How far occlusion reaches, in the scene's unit. */
    this.radius = uniform(0.25);
    /** Timestamps of the passes, if they are wanted, as `beginComputePass` takes them. */
    this.timestampWrites = undefined;
    this._texture = new ExternalTexture(white(network.device));
    this._textureNode = passTexture(this, this._texture);
  }

  getTextureNode() {
    return this._textureNode;
  }

  setup(builder) {
    // The pass that makes them is rendered before this.
    Object.assign(builder.getNodeProperties(this), {
      depthNode: this.depthNode,
      normalNode: this.normalNode,
    });
    return this._textureNode;
  }

  updateBefore({ renderer }) {
    const [depth, normal] = [this.depthNode, this.normalNode].map(
      (node) => renderer.backend.get(node.value).texture,
    );
    if (!depth || !normal) return false;
    if (depth.sampleCount > 1) throw new Error('learnedAO: the pass that makes depth wants { samples: 0 }');
    const { width, height } = depth;
    if (this._plan?.width !== width || this._plan?.height !== height) this._resize(renderer, width, height);
    const focalLength = 0.5 * height * this.camera.projectionMatrix.elements[5];
    this._plan.set({ radius: this.radius.value, focalLength });
    const encoder = this.network.device.createCommandEncoder({ label: 'deepshade' });
    this._reader.encode(encoder, {
      depth: depth.createView({ aspect: 'depth-only' }),
      normal: normal.createView(),
      inverseProjection: this.camera.projectionMatrixInverse.elements,
    });
    this._plan.encode(encoder, this.timestampWrites);
    this._image.encode(encoder);
    this.network.device.queue.submit([encoder.finish()]);
    return true;
  }

  _resize(renderer, width, height) {
    if (renderer.logarithmicDepthBuffer || !this.camera.isPerspectiveCamera) {
      throw new Error('learnedAO wants a perspective camera and no logarithmic depth buffer');
    }
    this._free();
    this._plan = this.network.plan(width, height);
    this._reader = new TextureReader(this._plan, { background: renderer.reversedDepthBuffer ? 0 : 1 });
    this._image = new ImageTexture(this._plan);
    // Three.js holds what it knows of a texture until that is disposed of.
    this._texture.dispose();
    this._texture.sourceTexture = this._image.texture;
    this._texture.needsUpdate = true;
  }

  _free() {
    [this._image, this._reader, this._plan].forEach((made) => made?.destroy());
    this._image = this._reader = this._plan = undefined;
  }

  dispose() {
    this._free();
    this._texture.dispose();
    super.dispose();
  }
}

/** A node with ambient occlusion by a network. */
export const learnedAO = (depthNode, normalNode, camera, network) =>
  new LearnedAONode(depthNode, normalNode, camera, network);

/** A pixel that nothing occludes, for frames before the first. */
function white(device) {
  const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
  const texture = device.createTexture({
    label: 'deepshade.white',
    size: [1, 1],
    format: 'rgba8unorm',
    usage,
  });
  device.queue.writeTexture({ texture }, new Uint8Array(4).fill(255), { bytesPerRow: 4 }, [1, 1]);
  return texture;
}
