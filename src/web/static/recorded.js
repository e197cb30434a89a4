// The comparison that the program recorded, where a browser cannot compute one.
import { choices, facts, figures, notes, part, passes, say, TRUTH, wipe } from "./parts.js";

export async function begin(reason) {
  const list = await (await fetch("recorded/recorded.json")).json();
  say(
    `${reason} Below is what the program computed beforehand, by the same code. The live comparison needs WebGPU: a ` +
      "browser that has it on this system, a graphics driver that it trusts, and a page sent by https or from this machine.",
  );
  part("page").hidden = false;
  part("wiped").classList.add("recorded");
  part("canvas").hidden = true;
  part("hint").textContent = "Drag the border.";
  for (const id of ["scene", "seed", "view", "size"]) part(id).closest("label").hidden = true;
  for (const id of ["left-image", "right-image"]) part(id).hidden = false;

  const effects = list.recorded.map((one) => one.wish.effect);
  choices(part("effect"), effects.map((name) => [name, name]), effects[0]);
  const recorded = () => list.recorded.find((one) => one.wish.effect === part("effect").value);
  const border = () => wipe(part("wipe").value / 1000);

  const seen = () => {
    const one = recorded();
    for (const side of ["left", "right"]) {
      const name = part(side).value;
      part(`${side}-image`).src = `recorded/${one.files[name]}.png`;
      part(`${side}-image`).alt = `${one.wish.effect} by ${name}`;
      part(`${side}-name`).textContent = name;
    }
    const time = (name) => one.milliseconds?.[one.passes.indexOf(name)];
    const rows = one.wish.methods.map((name) => [name, time(name), one.scores?.[name]]);
    figures(rows, [part("left").value, part("right").value]);
  };
  const chosen = () => {
    const one = recorded();
    const names = Object.keys(one.files).map((name) => [name, name]);
    choices(part("left"), names, one.wish.methods[0]);
    choices(part("right"), names, one.wish.methods[1] ?? TRUTH);
    passes(one.passes, one.milliseconds);
    part("truth").textContent = one.samples ? `Truth: path traced with ${one.samples} samples a pixel.` : "";
    facts([
      ["scene", `${one.wish.scene}, view ${one.wish.view}`],
      ...(one.wish.fog ? [["fog", `extinction ${one.wish.fog} per metre`]] : []),
      ["pixels", one.wish.size.join(" × ")],
      ["computed on", `${list.device}, ${list.machine.processor ?? ""}`],
      ["picture", one.exposure],
    ]);
    notes(one.added);
    seen();
  };
  part("effect").onchange = chosen;
  part("left").onchange = seen;
  part("right").onchange = seen;
  part("wipe").oninput = border;
  addEventListener("resize", border);
  chosen();
  border();
  document.body.dataset.state = `recorded ${TRUTH in recorded().files ? "with truth" : ""}`.trim();
}
