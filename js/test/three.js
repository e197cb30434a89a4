// What is measured in the example with three.js: milliseconds of a frame that each of the two nodes adds, and the
// mean of what each makes of openness.

/** Frames of which the median is taken. */
const FRAMES = 5;

export async function measured() {
  const { renderer, pipeline, theirs, ours } = window.deepshade;
  renderer.setAnimationLoop(null);
  const { queue } = renderer.backend.device;
  const frame = async () => {
    const began = performance.now();
    pipeline.render();
    await queue.onSubmittedWorkDone();
    return performance.now() - began;
  };
  const median = async () => {
    await frame();
    const times = [];
    for (let index = 0; index < FRAMES; index++) times.push(await frame());
    return times.sort((a, b) => a - b)[FRAMES >> 1];
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
  await frame();
  return {
    ms_browser_three_gtao: whole - noGtao,
    ms_browser_three_learned: whole - noLearned,
    mean_gtao: await mean(0),
    mean_learned: await mean(1),
  };
}

/** The mean of the canvas where occlusion alone is shown, of three.js at 0 and of deepshade at 1. */
async function mean(which) {
  const { renderer, pipeline } = window.deepshade;
  const set = (id, event, change) => {
    change(document.getElementById(id));
    document.getElementById(id).dispatchEvent(new Event(event));
  };
  set('wipe', 'input', (wipe) => (wipe.value = 1 - which));
  set('alone', 'change', (alone) => (alone.checked = true));
  pipeline.render();
  const { width, height } = renderer.domElement;
  const context = new OffscreenCanvas(width, height).getContext('2d');
  context.drawImage(renderer.domElement, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  let sum = 0;
  for (let index = 0; index < data.length; index += 4) sum += data[index] / 255;
  set('alone', 'change', (alone) => (alone.checked = false));
  set('wipe', 'input', (wipe) => (wipe.value = 0.5));
  pipeline.render();
  return sum / (width * height);
}
