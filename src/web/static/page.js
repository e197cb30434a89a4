// Begins with what the browser can do: the live comparison, or, without WebGPU, the recorded one.
import { say } from "./parts.js";

/** Why there can be no live comparison; nothing where there can. */
async function obstacle() {
  if (!navigator.gpu) {
    return isSecureContext
      ? "This browser has no WebGPU, with which the live comparison is computed."
      : "This page was not sent by https or from this machine, and browsers have WebGPU for such pages alone.";
  }
  const adapter = await navigator.gpu.requestAdapter().catch(() => null);
  return adapter ? "" : "This browser has WebGPU, but finds no graphics adapter for it.";
}

async function begin() {
  const reason = await obstacle();
  if (reason) {
    const { begin } = await import("./recorded.js");
    await begin(reason);
  } else {
    const { begin } = await import("./live.js");
    await begin();
  }
}

begin().catch((error) => say(`The page stopped: ${error.message ?? error}`, true));
