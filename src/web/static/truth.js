// Refines truth beside the page, pass by pass, until the page asks for truth of something else or has enough.
import init, { Truth } from "./deepshade.js";

const ready = init({ module_or_path: "deepshade_bg.wasm" });
let newest = 0;

self.onmessage = async ({ data: { sight, order, samples } }) => {
  newest = order;
  try {
    await ready;
    // A newer order may have come while the program was read.
    if (newest !== order) return;
    const truth = new Truth(sight);
    while (newest === order && truth.samples() < samples) {
      const count = Math.max(1, Math.min(16, truth.samples() / 8));
      const began = performance.now();
      const image = truth.refine(count);
      const seconds = (performance.now() - began) / 1000;
      self.postMessage({ order, image, samples: truth.samples(), seconds }, [image.buffer]);
      // Lets messages in.
      await new Promise((resolve) => setTimeout(resolve));
    }
    truth.free();
  } catch (error) {
    self.postMessage({ order, error: String(error) });
  }
};
