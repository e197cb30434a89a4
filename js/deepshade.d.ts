/// <reference types="@webgpu/types" />

/** Numbers of a frame. */
export interface Frame {
  /** How far the effect reaches, in the unit of positions. */
  radius: number;
  /** Half the image's height over the tangent of half the vertical field of view, in pixels. */
  focalLength: number;
  /** What light is multiplied by, for networks that read light. By default 1. */
  exposure?: number;
  /** Chooses random numbers. By default 0. */
  seed?: number;
}

/** A buffer of a g-buffer: planes of the image, 32-bit floats, row by row from the top. */
export interface Attribute {
  name: string;
  planes: number;
}

/** Fetches a network's files, which `deepshade export --wgsl` writes, and compiles its passes. */
export function load(url: string | URL, device: GPUDevice): Promise<Network>;

/** How far a network's image is off on the frame that was exported with it. */
export interface Checked {
  /** The largest difference. */
  largest: number;
  /** The share of the image's values that are off by more than 1e-3. Below .01 all is well. */
  stray: number;
}

/** Runs a network on the frame that was exported with it. */
export function check(url: string | URL, network: Network): Promise<Checked>;

/** The numbers of a buffer of a plan, such as `plan.image`. */
export function read(buffer: GPUBuffer, device: GPUDevice): Promise<Float32Array>;

/** A network on a device. */
export class Network {
  readonly device: GPUDevice;
  /** `network.json`. */
  readonly description: Record<string, unknown>;
  /** The effect's name. */
  readonly effect: string;
  /** What it reads of a g-buffer. */
  readonly attributes: Attribute[];
  /**
   * Bytes of the buffers that a frame of a size needs, by their names. A device has to allow the largest as
   * `maxStorageBufferBindingSize` and `maxBufferSize`.
   */
  bytes(width: number, height: number): Record<string, number>;
  /** Prepares frames of a size, in buffers of yours where `attributes` has them. */
  plan(width: number, height: number, attributes?: Record<string, GPUBuffer>): Plan;
  /** Frees its weights. Plans of it are of no use then. */
  destroy(): void;
}

/** A network for frames of a size. */
export class Plan {
  readonly network: Network;
  readonly width: number;
  readonly height: number;
  /** All storage buffers by their names, those of the attributes among them. */
  readonly buffers: Record<string, GPUBuffer>;
  /** The effect's image: planes of the image, 32-bit floats, row by row from the top. */
  readonly image: GPUBuffer;
  /** Tells the passes of a frame, from the next submission on. */
  set(frame: Frame): void;
  /** Records the passes, in a compute pass of their own. */
  encode(encoder: GPUCommandEncoder, timestampWrites?: GPUComputePassTimestampWrites): void;
  /** Frees what the plan made. */
  destroy(): void;
}

/** What a rasteriser has of a frame. */
export interface Textures {
  /** The depth texture. */
  depth: GPUTextureView;
  /** Normals in camera space: x to the right, y up, z towards the camera. */
  normal: GPUTextureView;
  /** The inverse of the projection, column after column. Depth is from 0 to 1 before it. */
  inverseProjection: ArrayLike<number>;
}

/** Writes the buffers `position`, `normal` and `valid` of a plan from textures. */
export class TextureReader {
  /**
   * `normals` says what the texture of normals holds: components from -1 to 1, or from 0 to 1. `background`
   * is the depth where nothing is seen: 1, or 0 with reversed depth.
   */
  constructor(plan: Plan, options?: { normals?: 'unit' | 'colour'; background?: 0 | 1 });
  /** Records it. */
  encode(encoder: GPUCommandEncoder, textures: Textures): void;
  /** Frees what it made. */
  destroy(): void;
}

/** A plan's image as a texture, `rgba16float`. */
export class ImageTexture {
  constructor(plan: Plan);
  readonly texture: GPUTexture;
  /** Records the copy. */
  encode(encoder: GPUCommandEncoder): void;
  /** Frees the texture. */
  destroy(): void;
}
