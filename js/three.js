// Ambient occlusion by a network of deepshade as a node of three.js, in the place of its GTAONode:
//
//   const network = await load('shaders/ao', renderer.backend.device);
//   const aoPass = learnedAO(prePassDepth, prePassNormal, camera, network);
//   scenePass.contextNode = builtinAOContext(aoPass.getTextureNode().sample(screenUV).r);

import { ImageTexture, TextureReader } from './deepshade.js';
import { ExternalTexture, Node, NodeUpdateType, Vector2 } from 'three/webgpu';
import { passTexture, uniform } from 'three/tsl';

const size = new Vector2();

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
    if (network.effect !== 'ao') throw new Error(`learnedAO wants a network of ao, this is one of ${network.effect}`);
    Object.assign(this, { depthNode, normalNode, camera, network });
    this.updateBeforeType = NodeUpdateType.FRAME;
    /** How far occlusion reaches, in the scene's unit. */
    this.radius = uniform(0.25);
    /** Timestamps of the passes, if they are wanted: `{ querySet, beginningOfPassWriteIndex, endOfPassWriteIndex }`. */
    this.timestampWrites = undefined;
    this._texture = new ExternalTexture();
    this._textureNode = passTexture(this, this._texture);
  }

  getTextureNode() {
    return this._textureNode;
  }

  setup() {
    return this._textureNode;
  }

  updateBefore({ renderer }) {
    const { width, height } = renderer.getDrawingBufferSize(size);
    const held = (node) => renderer.backend.get(node.value).texture;
    const [depth, normal] = [held(this.depthNode), held(this.normalNode)];
    if (!depth || !normal || depth.width !== width || depth.height !== height) return;
    if (this._plan?.width !== width || this._plan?.height !== height) this._resize(renderer, width, height);
    const focalLength = 0.5 * height * this.camera.projectionMatrix.elements[5];
    this._plan.set({ radius: this.radius.value, focalLength });
    const encoder = this.network.device.createCommandEncoder({ label: 'deepshade' });
    this._reader.encode(encoder, this._plan, {
      depth: depth.createView({ aspect: 'depth-only' }),
      normal: normal.createView(),
      inverseProjection: this.camera.projectionMatrixInverse.elements,
    });
    this._plan.encode(encoder, this.timestampWrites);
    this._image.encode(encoder);
    this.network.device.queue.submit([encoder.finish()]);
  }

  _resize(renderer, width, height) {
    this._free();
    this._plan = this.network.plan(width, height);
    this._image = new ImageTexture(this._plan);
    const background = renderer.reversedDepthBuffer ? 0 : 1;
    this._reader ??= new TextureReader(this.network.device, { background });
    this._texture.sourceTexture = this._image.texture;
    this._texture.needsUpdate = true;
  }

  _free() {
    this._plan?.destroy();
    this._image?.texture.destroy();
  }

  dispose() {
    this._free();
    super.dispose();
  }
}

/** A node with ambient occlusion by a network. */
export const learnedAO = (depthNode, normalNode, camera, network) =>
  new LearnedAONode(depthNode, normalNode, camera, network);
