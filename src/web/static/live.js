// The live comparison: what hands choose goes to the program, frame by frame, and what it says comes back.
import init, { choices as known, Page, shaders } from "./deepshade.js";
import { choices, facts, figures, notes, part, passes, say, TRUTH, wipe } from "./parts.js";

const address = new URLSearchParams(location.search);
/** Samples of a pixel of truth. */
const SAMPLES = Number(address.get("samples") ?? 256);
/** Milliseconds that hands rest before truth begins. */
const REST = 400;
/** Frames that are made after hands have let go where the clock of a graphics card tells of frames before. */
const AFTER = 12;

export async function begin() {
  say("Reading the program.");
  await init({ module_or_path: "deepshade_bg.wasm" });
  const [models, recorded] = await Promise.all(
    ["models/models.json", "recorded/recorded.json"].map(async (path) => (await fetch(path)).json()),
  );
  const page = await Page.open(part("canvas"));
  const live = new Live(page, JSON.parse(known()), models, recorded.recorded);
  // For scripts that drive the page: the program's shaders, and the values that a method makes of the picture,
  // [channels, height, width].
  const values = (name) => new Promise((resolve, reject) => live.wanting.push({ name, resolve, reject }));
  window.deepshade = { shaders: () => JSON.parse(shaders()), values };
  live.run();
}

class Live {
  constructor(page, known, models, recorded) {
    Object.assign(this, { page, recorded });
    const can = (effect) => effect.methods.filter((name) => name !== "learned" || models.includes(effect.name));
    this.effects = new Map(known.effects.map((effect) => [effect.name, { ...effect, methods: can(effect) }]));
    this.hands = { right: 0, up: 0, nearer: 1 };
    this.time = 0;
    this.frames = 0;
    this.order = 0;
    this.scores = {};
    this.wanting = [];
    this.models = new Map();
    this.worker = new Worker("truth.js", { type: "module" });
    this.worker.onmessage = ({ data }) => data.order === this.order && (this.arrived = data);
    this.fill(known.scenes);
    this.listen();
  }

  /** Choices, as the address says, else as they were recorded. */
  fill(scenes) {
    const shown = [...this.effects.values()].filter((effect) => effect.methods.length);
    const first = address.get("effect") ?? this.recorded[0].wish.effect;
    choices(part("effect"), shown.map(({ name }) => [name, name]), first);
    choices(part("scene"), scenes.map(({ name, about }) => [name, `${name}: ${about}`]));
    const sizes = [...new Set([128, 192, 256, 384, 512, 768, Number(address.get("size") ?? 384)])].sort((a, b) => a - b);
    choices(part("size"), sizes.map((size) => [String(size), `${size} × ${size}`]), address.get("size") ?? "384");
    this.chooseEffect();
  }

  /** An effect with the scene and the methods that it is recorded with, or the first ones. */
  chooseEffect() {
    const effect = this.effects.get(part("effect").value);
    const wish = this.recorded.find((one) => one.wish.effect === effect.name)?.wish;
    const given = effect.name === address.get("effect") ? address : new URLSearchParams();
    const [scene, seed] = (given.get("scene") ?? wish?.scene ?? "playground:3").split(":");
    part("scene").value = scene;
    part("seed").value = seed;
    part("view").value = given.get("view") ?? (given.has("scene") ? 0 : (wish?.view ?? 0));
    part("foggy").hidden = !effect.fog;
    part("fog").value = given.get("fog") ?? (given.has("scene") ? "" : (wish?.fog ?? ""));
    const names = [...effect.methods, TRUTH].map((name) => [name, name]);
    choices(part("left"), names, given.get("left") ?? wish?.methods[0] ?? effect.methods[0]);
    choices(part("right"), names, given.get("right") ?? wish?.methods[1] ?? effect.methods[1] ?? TRUTH);
    this.wanted = true;
  }

  listen() {
    part("effect").onchange = () => this.chooseEffect();
    const chosen = ["scene", "seed", "view", "left", "right", "size", "fog"];
    for (const id of chosen) part(id).onchange = () => (this.wanted = true);
    const canvas = part("canvas");
    const pointers = new Map();
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
    };
    canvas.onpointerup = canvas.onpointercancel = (event) => pointers.delete(event.pointerId);
    canvas.onpointermove = (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      pointers.set(event.pointerId, event);
      const others = [...pointers.values()].filter((other) => other.pointerId !== event.pointerId);
      if (others.length) {
        const apart = ({ clientX, clientY }) => Math.hypot(clientX - others[0].clientX, clientY - others[0].clientY);
        this.hands.nearer *= apart(before) / Math.max(apart(event), 1);
      } else {
        // As in the window: half a turn or so through the picture's height.
        const turn = 2.5 / canvas.clientHeight;
        this.hands.right -= (event.clientX - before.clientX) * turn;
        this.hands.up += (event.clientY - before.clientY) * turn;
      }
    };
    canvas.onwheel = (event) => {
      event.preventDefault();
      this.hands.nearer *= Math.exp(0.001 * event.deltaY);
    };
    document.addEventListener("visibilitychange", () => (this.frames = this.after));
  }

  /** Frames that are made after hands have let go, until their milliseconds are known. */
  get after() {
    return this.told?.tells_later ? AFTER : 1;
  }

  /** Sides that are seen, and the methods that make them. */
  get sides() {
    return [part("left").value, part("right").value];
  }

  async run() {
    for (const id of ["page", "live"]) part(id).hidden = false;
    say("");
    for (;;) {
      try {
        await this.turn();
      } catch (error) {
        document.body.dataset.state = "failed";
        const stopped = error instanceof WebAssembly.RuntimeError;
        say(stopped ? "The page stopped: the browser may have lost its graphics device. Load it again." : `${error.message ?? error}`, true);
        this.told = undefined;
        // Until something else is chosen.
        while (!this.wanted) await new Promise(requestAnimationFrame);
      }
      await new Promise(requestAnimationFrame);
    }
  }

  async turn() {
    if (this.wanted) await this.prepare();
    const { right, up, nearer } = this.hands;
    const moved = right !== 0 || up !== 0 || nearer !== 1;
    if (moved) {
      this.hands = { right: 0, up: 0, nearer: 1 };
      this.page.orbit(right, up, nearer);
    }
    const playing = part("playing").checked;
    const now = performance.now();
    if (playing) this.time += Math.min(0.1, (now - (this.last ?? now)) / 1000);
    this.last = now;
    if (moved || playing) {
      this.frames = this.after;
      this.forgetTruth();
      this.rested = now + REST;
    }
    if (this.frames > 0) {
      this.frames -= 1;
      this.made = (this.made ?? 0) + 1;
      const times = JSON.parse(await this.page.frame(this.time));
      if (times) {
        this.times = times;
        this.show();
      }
    }
    if (this.arrived) await this.score();
    if (this.frames === 0 && this.wanting.length) {
      const { name, resolve, reject } = this.wanting.shift();
      await this.page.image(name).then(resolve, reject);
    }
    if (!playing && this.frames === 0 && !this.asked && now > this.rested) this.ask();
    const drawn = this.sides.map((name) => (name === TRUTH && !this.scored ? this.told.methods[0] : name));
    const border = wipe(part("wipe").value / 1000);
    const seen = [this.made, this.scored, border, ...drawn].join();
    if (seen !== this.seen) this.page.draw(drawn[0], drawn[1], border);
    this.seen = seen;
    const wrong = this.page.wrong();
    if (wrong) throw new Error(`The device refuses something: ${wrong}`);
  }

  /** Has the program prepare what is chosen. */
  async prepare() {
    this.wanted = false;
    this.forgetTruth();
    document.body.dataset.state = "preparing";
    const effect = this.effects.get(part("effect").value);
    const named = [...new Set(this.sides.filter((name) => name !== TRUTH))];
    const methods = named.length ? named : [effect.methods[0]];
    const scene = `${part("scene").value}:${Number(part("seed").value) || 0}`;
    const size = Number(part("size").value);
    say(`Preparing ${effect.name} of ${scene}.`);
    part("wiped").classList.add("waits");
    // Lets the browser show that.
    await new Promise((resolve) => setTimeout(resolve, 30));
    const view = Number(part("view").value) || 0;
    const fog = effect.fog && Number(part("fog").value) > 0 ? Number(part("fog").value) : undefined;
    const wish = { scene, view, effect: effect.name, methods, size: [size, size], fog };
    const [spec, weights] = methods.includes("learned") ? await this.model(effect.name) : [];
    this.told = JSON.parse(await this.page.show(JSON.stringify(wish), spec, weights));
    say("");
    part("wiped").classList.remove("waits");
    part("moving").hidden = !this.told.goes_on;
    if (!this.told.goes_on) part("playing").checked = false;
    const rested = performance.now();
    Object.assign(this, { time: 0, frames: this.after, times: undefined, scores: {}, rested });
    for (const side of ["left", "right"]) part(`${side}-name`).textContent = part(side).value;
    const left = effect.processor.length ? [`Methods that run on the processor alone, and not in this page: ${effect.processor.join(", ")}.`] : [];
    facts([
      ["scene", `${scene}, view ${view}, ${this.told.triangles} triangles`],
      ["radius", `${this.told.radius.toFixed(3)} m`],
      ["device", this.page.device()],
      ["picture", this.told.exposure],
      ["values", effect.unit],
    ]);
    notes([...this.told.added, ...left]);
    this.show();
    document.body.dataset.state = "ready";
  }

  /** The two files of an effect's network. */
  async model(effect) {
    if (!this.models.has(effect)) {
      const files = ["net.json", "weights.safetensors"].map(async (file) => {
        const answer = await fetch(`models/${effect}/${file}`);
        if (!answer.ok) throw new Error(`models/${effect}/${file}: ${answer.status}`);
        return new Uint8Array(await answer.arrayBuffer());
      });
      this.models.set(effect, await Promise.all(files));
    }
    return this.models.get(effect);
  }

  /** Truth of what is seen now. */
  ask() {
    if (SAMPLES === 0) return;
    this.asked = true;
    this.order += 1;
    this.worker.postMessage({ sight: this.page.sight(), order: this.order, samples: SAMPLES });
    part("truth").textContent = "Truth: being path traced on the processor.";
  }

  forgetTruth() {
    this.order += 1;
    this.scores = {};
    this.asked = this.scored = false;
    this.arrived = undefined;
    part("truth").textContent = "";
  }

  async score() {
    const { image, samples, seconds, error } = this.arrived;
    this.arrived = undefined;
    if (error) {
      part("truth").textContent = `Truth: ${error}`;
      return;
    }
    this.scores = JSON.parse(await this.page.score(image));
    this.scored = true;
    const state = samples < SAMPLES ? `, of ${SAMPLES}` : "";
    part("truth").textContent =
      `Truth: path traced on one thread of the processor, ${samples} samples a pixel${state}; the last pass took ${seconds.toFixed(1)} s.`;
    document.body.dataset.samples = samples;
    this.show();
  }

  show() {
    const time = (name) => this.times?.[this.told.passes.indexOf(name)];
    figures(this.told.methods.map((name) => [name, time(name), this.scores[name]]), this.sides);
    passes(this.told.passes, this.times);
  }
}
