"use strict";

// What is shown is one object; every control changes it, and `show` makes the page say the same. It is kept in the
// page's address, so that a view can be sent to somebody.
const data = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];
const zooms = ["fit", "1", "2", "4", "8"];
const limits = { min: 0, max: 100 };

// Images are known by the names of their files; frames list them with their labels, truth last.
const frame = () => data.frames[state.frame];
const files = () => frame().images.map(([, file]) => file);
const label = (file) => frame().images.find(([, other]) => other === file)[0];
const measures = [...new Set(all(".measured").map((plot) => plot.dataset.measure))];

const state = {
  frame: 0,
  left: data.frames[0].images[0][1],
  right: "truth",
  view: data.views[0],
  zoom: zooms[0],
  wipe: 50,
  measure: measures[0],
};

// A method's picture in the frame and view that are shown.
const source = (file) => `${frame().folder}/${file}.${state.view}.png`;

function readAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const pick = (name, allowed) => {
    if (allowed.includes(asked.get(name))) state[name] = asked.get(name);
  };
  const index = Number(asked.get("frame") ?? state.frame);
  if (Number.isInteger(index) && index >= 0 && index < data.frames.length) state.frame = index;
  pick("left", files());
  pick("right", files());
  pick("view", data.views);
  pick("zoom", zooms);
  pick("measure", measures);
  const wipe = Number(asked.get("wipe") ?? state.wipe);
  if (wipe >= limits.min && wipe <= limits.max) state.wipe = wipe;
}

function writeAddress() {
  history.replaceState(null, "", "#" + new URLSearchParams(state));
}

// The canvas is the picture's own size times the zoom, or the largest size that fits. What was in the middle of the
// stage stays there.
function resize() {
  const { width, height } = frame();
  const stage = element("stage");
  const canvas = element("canvas");
  const middle = (scroll, stage, canvas) => (canvas > stage ? (scroll + stage / 2) / canvas : 0.5);
  const x = middle(stage.scrollLeft, stage.clientWidth, canvas.offsetWidth);
  const y = middle(stage.scrollTop, stage.clientHeight, canvas.offsetHeight);
  const room = Math.min(stage.clientWidth / width, (0.85 * innerHeight) / height);
  const scale = state.zoom === "fit" ? room : Number(state.zoom);
  canvas.style.width = `${width * scale}px`;
  canvas.style.height = `${height * scale}px`;
  canvas.classList.toggle("pixels", state.zoom !== "fit");
  stage.scrollLeft = x * canvas.offsetWidth - stage.clientWidth / 2;
  stage.scrollTop = y * canvas.offsetHeight - stage.clientHeight / 2;
}

function showWipe() {
  element("wipe").value = state.wipe;
  element("canvas").style.setProperty("--split", `${state.wipe}%`);
}

// Scrolls the strip of frames, and not the page.
function bringIntoStrip(button) {
  const strip = button.parentElement;
  const start = button.offsetLeft - strip.offsetLeft;
  const end = start + button.offsetWidth - strip.clientWidth;
  strip.scrollLeft = Math.min(start, Math.max(strip.scrollLeft, end));
}

// What the frame that is shown has; another frame may have other images.
function showChoices() {
  if (!files().includes(state.left)) state.left = files()[0];
  if (!files().includes(state.right)) state.right = "truth";
  for (const side of ["left", "right"]) {
    element(side).replaceChildren(...frame().images.map(([name, file]) => new Option(name, file)));
    element(side).value = state[side];
  }
}

function showPair() {
  for (const side of ["left", "right"]) {
    element(`image-${side}`).src = source(state[side]);
    element(`image-${side}`).alt = `${label(state[side])}, ${state.view}`;
    element(`tag-${side}`).textContent = label(state[side]);
  }
}

// All images of the frame side by side; a click puts one on the left.
function showAll() {
  const pictures = frame().images.map(([name, file]) => {
    const button = document.createElement("button");
    const picture = document.createElement("img");
    picture.src = source(file);
    picture.alt = "";
    button.type = "button";
    button.title = `Show ${name} on the left`;
    button.append(picture, name);
    button.addEventListener("click", () => change({ left: file }));
    return button;
  });
  element("all").replaceChildren(...pictures);
}

// Of several effects one is shown, that of the frame.
function showEffect() {
  const effect = frame().effect;
  for (const part of all(".effect, .frames button")) part.hidden = part.dataset.effect !== effect;
  for (const button of all(".effects button")) {
    button.toggleAttribute("aria-current", button.dataset.effect === effect);
  }
  for (const plot of all(".measured")) plot.hidden = plot.dataset.measure !== state.measure;
  for (const radio of all(".measure input")) radio.checked = radio.value === state.measure;
}

function show() {
  for (const name of ["view", "zoom"]) {
    for (const radio of all(`input[name=${name}]`)) radio.checked = radio.value === state[name];
  }
  for (const legend of all(".legend")) legend.hidden = legend.dataset.view !== state.view;
  for (const section of all(".frame")) section.hidden = Number(section.dataset.frame) !== state.frame;
  for (const button of all(".frames button")) {
    const current = Number(button.dataset.frame) === state.frame;
    button.toggleAttribute("aria-current", current);
    if (current) bringIntoStrip(button);
  }
  showEffect();
  showChoices();
  showPair();
  showAll();
  showWipe();
  resize();
}

function change(values) {
  Object.assign(state, values);
  show();
  writeAddress();
}

// Sorts a table by a column, and the other way round the second time. Lines that are no method's stay at the end.
function sort(button) {
  const head = button.closest("th");
  const heads = [...head.parentNode.children];
  const column = heads.indexOf(head);
  const first = button.dataset.first ?? "ascending";
  const other = first === "ascending" ? "descending" : "ascending";
  const order = head.getAttribute("aria-sort") === first ? other : first;
  for (const each of heads) each.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", order);
  const body = head.closest("table").tBodies[0];
  const value = (row) => row.children[column].dataset.value ?? row.children[column].textContent;
  const compare = (a, b) => a.localeCompare(b, undefined, { numeric: true });
  const numbers = (a, b) => Number(a) - Number(b);
  const by = head.classList.contains("text") ? compare : numbers;
  const sign = order === "ascending" ? 1 : -1;
  const isMethod = (row) => row.classList.contains("method");
  const rows = [...body.rows].sort(
    (a, b) => isMethod(b) - isMethod(a) || (isMethod(a) ? sign * by(value(a), value(b)) : 0),
  );
  body.replaceChildren(...rows);
}

// The index `step` away, going round.
const around = (index, step, count) => (index + step + count) % count;
const stepFrame = (step) => change({ frame: around(state.frame, step, data.frames.length) });
// The same view in another effect, or that effect's first.
function showFrameOf(effect) {
  const here = frame();
  const same = (other) => other.effect === effect && other.scene === here.scene && other.view === here.view;
  const index = data.frames.findIndex(same);
  change({ frame: index >= 0 ? index : data.frames.findIndex((other) => other.effect === effect) });
}
const swap = () => change({ left: state.right, right: state.left, wipe: state.wipe });
const stepZoom = (step) => {
  const index = zooms.indexOf(state.zoom) + step;
  change({ zoom: zooms[Math.min(Math.max(index, 0), zooms.length - 1)] });
};
const keys = {
  1: () => change({ view: data.views[0] }),
  2: () => change({ view: data.views[1] }),
  3: () => change({ view: data.views[2] }),
  s: swap,
  n: () => stepFrame(1),
  p: () => stepFrame(-1),
  "+": () => stepZoom(1),
  "-": () => stepZoom(-1),
};

element("left").addEventListener("change", (event) => change({ left: event.target.value }));
element("right").addEventListener("change", (event) => change({ right: event.target.value }));
element("view").addEventListener("change", (event) => change({ view: event.target.value }));
element("zoom").addEventListener("change", (event) => change({ zoom: event.target.value }));
element("swap").addEventListener("click", swap);
element("wipe").addEventListener("input", (event) => {
  state.wipe = Number(event.target.value);
  showWipe();
});
element("wipe").addEventListener("change", writeAddress);
for (const button of all(".frames button")) {
  button.addEventListener("click", () => change({ frame: Number(button.dataset.frame) }));
}
for (const button of all(".effects button")) {
  button.addEventListener("click", () => showFrameOf(button.dataset.effect));
}
for (const fieldset of all(".measure")) {
  fieldset.addEventListener("change", (event) => change({ measure: event.target.value }));
}
for (const button of all(".sort")) button.addEventListener("click", () => sort(button));
document.addEventListener("keydown", (event) => {
  const typing = event.target.tagName === "SELECT" || event.ctrlKey || event.metaKey || event.altKey;
  if (typing || !(event.key in keys)) return;
  event.preventDefault();
  keys[event.key]();
});
addEventListener("resize", resize);
addEventListener("hashchange", () => {
  readAddress();
  show();
});

readAddress();
show();
