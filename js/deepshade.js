// Runs deepshade's networks in WebGPU, from the files that `deepshade export --wgsl` writes: all compute
// passes from a g-buffer to the effect's image. The files' own HOST.md says what they hold.

export { ImageTexture, TextureReader } from './textures.js';

/** Fetches a network's files and compiles its passes. */
export async function load(url, device) {
  if (!device?.createBindGroupLayout) {
    throw new Error('deepshade: no GPUDevice was given; has the renderer fallen back to WebGL?');
  }
  const folder = folderOf(url);
  const description = JSON.parse(await text(folder, 'network.json'));
  if (description.half && !device.features.has('shader-f16')) {
    throw new Error(`${folder}: the device lacks the feature shader-f16; export the network without --half`);
  }
  const files = Object.entries(description.buffers).filter(([, buffer]) => buffer.file);
  const contents = await Promise.all(
    files.map(async ([name, { file }]) => [name, await bytes(folder, file)]),
  );
  const passes = await Promise.all(
    description.passes.map(async (pass) => compiled(device, pass, await text(folder, pass.file))),
  );
  return new Network(device, description, passes, contents);
}

/**
 * Runs a network on the frame that was exported with it. Resolves to how far its image is off at most, and
 * the share of its values that are off by more than 1e-3: below .01 all is well.
 */
export async function check(url, network) {
  const folder = folderOf(url);
  const held = JSON.parse(await text(folder, 'check.json'));
  const expected = new Float32Array(await bytes(folder, 'check.image.bin'));
  const { device } = network;
  const plan = network.plan(held.width, held.height);
  try {
    for (const { name } of network.attributes) {
      device.queue.writeBuffer(plan.buffers[name], 0, await bytes(folder, `check.${name}.bin`));
    }
    plan.set({ ...held, focalLength: held.focal_length });
    const encoder = device.createCommandEncoder();
    plan.encode(encoder);
    device.queue.submit([encoder.finish()]);
    const made = await read(plan.image, device);
    const apart = expected.map((value, index) => Math.abs(value - made[index]));
    const largest = apart.reduce((most, value) => (value <= most ? most : value), 0);
    return { largest, stray: apart.filter((value) => !(value <= 1e-3)).length / apart.length };
  } finally {
    plan.destroy();
  }
}

/** The numbers of a buffer of a plan, such as `plan.image`. */
export async function read(buffer, device) {
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const copy = device.createBuffer({ size: buffer.size, usage });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, 0, copy, 0, buffer.size);
  device.queue.submit([encoder.finish()]);
  await copy.mapAsync(GPUMapMode.READ);
  const numbers = new Float32Array(copy.getMappedRange().slice(0));
  copy.destroy();
  return numbers;
}

/** A network on a device. */
export class Network {
  constructor(device, description, passes, contents) {
    Object.assign(this, { device, description, passes });
    this.files = new Map(contents.map(([name, content]) => [name, filled(device, name, content)]));
  }

  /** The effect's name. */
  get effect() {
    return this.description.effect;
  }

  /** The attributes of the g-buffer that it reads: names, and planes of each. */
  get attributes() {
    const planes = (name) => this.description.buffers[name].attribute;
    return this.description.attributes.map((name) => ({ name, planes: planes(name) }));
  }

  /**
   * Bytes of the buffers that a frame of a size needs, by their names, those of attributes among them. A
   * device has to allow the largest as `maxStorageBufferBindingSize` and `maxBufferSize`.
   */
  bytes(width, height) {
    const made = Object.entries(this.description.buffers).filter(([, buffer]) => !buffer.file);
    const size = (parts) =>
      parts.reduce(
        (sum, { over, planes, bytes }) => sum + area(extent(over, [height, width])) * planes * bytes,
        0,
      );
    const bytesOf = ({ attribute, made }) => (made ? size(made) : 4 * attribute * width * height);
    return Object.fromEntries(made.map(([name, buffer]) => [name, Math.max(bytesOf(buffer), 16)]));
  }

  /**
   * Prepares frames of a size. Buffers of attributes may be given; those that are not are made, to be filled
   * through `plan.buffers`.
   */
  plan(width, height, attributes = {}) {
    return new Plan(this, [height, width], attributes);
  }

  /** Frees its weights. Plans of it are of no use then. */
  destroy() {
    this.files.forEach((buffer) => buffer.destroy());
  }
}

/** A network for frames of a size. */
export class Plan {
  constructor(network, size, attributes) {
    const { device, description } = network;
    const [height, width] = size;
    if (!size.every((number) => Number.isInteger(number) && number > 0)) {
      throw new Error(`deepshade: frames of ${width}x${height}; whole numbers above 0 are wanted`);
    }
    const bytes = network.bytes(width, height);
    suited(network, bytes, attributes);
    allowed(device, `${width}x${height}`, bytes);
    Object.assign(this, { network, size, width, height, own: [] });
    const made = (name) => this.#made(name, bytes[name], STORAGE);
    const held = (name) => attributes[name] ?? network.files.get(name) ?? made(name);
    /** All storage buffers by their names. */
    this.buffers = Object.fromEntries(Object.keys(description.buffers).map((name) => [name, held(name)]));
    const runs = [...Array(description.runs).keys()];
    this.steps = runs.flatMap((run) =>
      network.passes.filter((pass) => run === 0 || pass.each_run).map((pass) => this.#step(pass, run)),
    );
  }

  /** The effect's image: planes of the image, 32-bit floats, row by row from the top. */
  get image() {
    return this.buffers.image;
  }

  #made(name, size, usage) {
    const made = this.network.device.createBuffer({ label: `deepshade.${name}`, size, usage });
    this.own.push(made);
    return made;
  }

  #step(pass, run) {
    const uniform = this.#made(pass.name, pass.uniform_bytes, UNIFORM);
    const storage = Object.entries(pass.bindings).map(([binding, { buffer }]) => ({
      binding: Number(binding),
      resource: { buffer: this.buffers[buffer] },
    }));
    const entries = [{ binding: 0, resource: { buffer: uniform } }, ...storage];
    const group = this.network.device.createBindGroup({ layout: pass.layout, entries });
    const [rows, columns] = extent(pass.over, this.size);
    const groups = [Math.ceil(columns / pass.tile[0]), Math.ceil(rows / pass.tile[1]), pass.workgroups_z];
    return { pass, run, uniform, group, groups };
  }

  /**
   * Tells the passes of a frame, from the next submission on: `radius` in the unit of positions,
   * `focalLength` in pixels, `exposure` for networks that read light.
   */
  set({ radius, focalLength, exposure = 1, seed = 0 }) {
    for (const [name, value] of Object.entries({ radius, focalLength, exposure, seed })) {
      if (!Number.isFinite(value)) throw new Error(`deepshade: ${name} is ${value}; a number is wanted`);
    }
    this.isTold = true;
    const frame = { radius, focal_length: focalLength, exposure, seed };
    for (const { pass, run, uniform } of this.steps) {
      const told = new DataView(new ArrayBuffer(pass.uniform_bytes));
      for (const { kind, offset, value } of pass.uniform) {
        const number = numberOf(value, { ...frame, run }, this.size);
        if (kind === 'f32') told.setFloat32(offset, number, true);
        else if (kind === 'i32') told.setInt32(offset, number, true);
        else told.setUint32(offset, number, true);
      }
      this.network.device.queue.writeBuffer(uniform, 0, told.buffer);
    }
  }

  /** Records the passes, in a compute pass of their own. */
  encode(encoder, timestampWrites) {
    if (!this.isTold) throw new Error('deepshade: call set of the plan before encode');
    const compute = encoder.beginComputePass({ label: 'deepshade', timestampWrites });
    for (const { pass, group, groups } of this.steps) {
      compute.setPipeline(pass.pipeline);
      compute.setBindGroup(0, group);
      compute.dispatchWorkgroups(...groups);
    }
    compute.end();
  }

  /** Frees what the plan made. */
  destroy() {
    this.own.forEach((buffer) => buffer.destroy());
  }
}

const STORAGE = 0x8c; // STORAGE, COPY_SRC and COPY_DST
const UNIFORM = 0x48; // UNIFORM and COPY_DST

const folderOf = (url) => String(url).replace(/\/?$/, '/');

async function bytes(folder, name) {
  const response = await fetch(folder + name);
  if (!response.ok) throw new Error(`${folder}${name}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
}

const text = async (folder, name) => new TextDecoder().decode(await bytes(folder, name));

const area = ([rows, columns]) => rows * columns;

/** Rows and columns of an extent for an image of a size. */
const extent = ({ align, shift }, size) => size.map((size) => (Math.ceil(size / align) * align) >> shift);

/** What a field of a uniform buffer holds. */
function numberOf(value, frame, size) {
  if (value.rows) return extent(value.rows, size)[0];
  if (value.columns) return extent(value.columns, size)[1];
  if (value.times) return frame[value.times[0]] * value.times[1];
  if (value.over) return value.over[0] / frame[value.over[1]];
  return value.constant;
}

/** Throws if buffers that are given are not attributes of a network, or too small. */
function suited(network, bytes, given) {
  const names = network.attributes.map(({ name }) => name);
  for (const [name, buffer] of Object.entries(given)) {
    if (!names.includes(name))
      throw new Error(`deepshade: the network reads ${names.join(', ')}, not ${name}`);
    if (buffer.size < bytes[name]) {
      throw new Error(`deepshade: the buffer ${name} has ${buffer.size} bytes; ${bytes[name]} are needed`);
    }
  }
}

/** Throws if a device does not allow buffers of these sizes. */
function allowed(device, frame, sizes) {
  const { maxStorageBufferBindingSize, maxBufferSize } = device.limits;
  const limit = Math.min(maxStorageBufferBindingSize, maxBufferSize);
  for (const [name, size] of Object.entries(sizes)) {
    if (size > limit) {
      throw new Error(
        `deepshade: frames of ${frame} need ${size} bytes for ${name}, the device allows ${limit}; ask for ` +
          'more in requiredLimits (maxStorageBufferBindingSize, maxBufferSize), or for smaller frames',
      );
    }
  }
}

function filled(device, name, content) {
  const size = Math.ceil(content.byteLength / 16) * 16;
  const buffer = device.createBuffer({ label: `deepshade.${name}`, size, usage: STORAGE });
  device.queue.writeBuffer(buffer, 0, content);
  return buffer;
}

async function compiled(device, pass, code) {
  const label = `deepshade.${pass.name}`;
  const storage = Object.entries(pass.bindings).map(([binding, { written }]) => ({
    binding: Number(binding),
    visibility: GPUShaderStage.COMPUTE,
    buffer: { type: written ? 'storage' : 'read-only-storage' },
  }));
  const uniform = { binding: 0, visibility: GPUShaderStage.COMPUTE, buffer: { type: 'uniform' } };
  const layout = device.createBindGroupLayout({ label, entries: [uniform, ...storage] });
  const pipeline = await device.createComputePipelineAsync({
    label,
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
    compute: { module: device.createShaderModule({ label, code }), entryPoint: pass.entry },
  });
  return { ...pass, layout, pipeline };
}
