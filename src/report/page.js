"use strict";

// What is shown is one object; every control changes it, and `show` makes the page say the same. It is kept in the
// page's address, so that a view can be sent to somebody.
const data = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];
const zooms = ["fit", "1", "2", "4", "8"];
const limits = { min: 0, max: 100 };

const state = {
  frame: 0,
  left: data.images[0],
  right: data.images[data.images.length - 1],
  view: data.views[0],
  zoom: zooms[0],
  wipe: 50,
};

// A method's picture in the frame and view that are shown.
const source = (image) => `${data.frames[state.frame].folder}/${image}.${state.view}.png`;

function readAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const pick = (name, allowed) => {
    if (allowed.includes(asked.get(name))) state[name] = asked.get(name);
  };
  pick("left", data.images);
  pick("right", data.images);
  pick("view", data.views);
  pick("zoom", zooms);
  const frame = Number(asked.get("frame") ?? state.frame);
  if (Number.isInteger(frame) && frame >= 0 && frame < data.frames.length) state.frame = frame;
  const wipe = Number(asked.get("wipe") ?? state.wipe);
  if (wipe >= limits.min && wipe <= limits.max) state.wipe = wipe;
}

function writeAddress() {
  history.replaceState(null, "", "#" + new URLSearchParams(state));
}

// The canvas is the picture's own size times the zoom, or the largest size that fits. What was in the middle of the
// stage stays there.
function resize() {
  const { width, height } = data.frames[state.frame];
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

function showPair() {
  for (const side of ["left", "right"]) {
    element(side).value = state[side];
    element(`image-${side}`).src = source(state[side]);
    element(`image-${side}`).alt = `${state[side]}, ${state.view}`;
    element(`tag-${side}`).textContent = state[side];
  }
}

// All images of the frame side by side; a click puts one on the left.
function showAll() {
  const pictures = data.images.map((image) => {
    const button = document.createElement("button");
    const picture = document.createElement("img");
    picture.src = source(image);
    picture.alt = "";
    button.type = "button";
    button.title = `Show ${image} on the left`;
    button.append(picture, image);
    button.addEventListener("click", () => change({ left: image }));
    return button;
  });
  element("all").replaceChildren(...pictures);
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
    if (current) button.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
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

// The index `step` away, going round.
const around = (index, step, count) => (index + step + count) % count;
const stepFrame = (step) => change({ frame: around(state.frame, step, data.frames.length) });
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
