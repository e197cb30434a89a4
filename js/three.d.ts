import type { Network } from 'deepshade';
import type { Camera, Node, TextureNode } from 'three/webgpu';

/** A node whose texture has ambient occlusion that a network makes of depth and normals. */
export class LearnedAONode extends Node {
  constructor(depthNode: TextureNode, normalNode: TextureNode, camera: Camera, network: Network);
  /** How far occlusion reaches, in the scene's unit. By default .25. */
  readonly radius: { value: number };
  /** Timestamps of the passes, if they are wanted. */
  timestampWrites?: GPUComputePassTimestampWrites;
  /** Its texture: openness in red, green and blue. */
  getTextureNode(): TextureNode;
}

/**
 * Ambient occlusion by a network, in the place of three.js's `ao`. `depthNode` and `normalNode` are textures
 * of a pass without multisampling, normals by `normalView`.
 */
export function learnedAO(
  depthNode: TextureNode,
  normalNode: TextureNode,
  camera: Camera,
  network: Network,
): LearnedAONode;
