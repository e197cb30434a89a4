// The page's parts, which the live and the recorded comparison have in common.

export const part = (id) => document.getElementById(id);

export const TRUTH = "truth";

/** Says something above the comparison; nothing where there is nothing to say. */
export function say(text, wrong = false) {
  part("message").textContent = text;
  part("message").classList.toggle("wrong", wrong);
}

/** Fills a list of choices, `[value, text]` each, and chooses one. */
export function choices(select, all, chosen) {
  select.replaceChildren(...all.map(([value, text]) => new Option(text, value, false, value === chosen)));
  if (!all.some(([value]) => value === chosen) && all.length) select.value = all[0][0];
}

/** Puts the border, and the thumb that holds it, at a share of the width. */
export function wipe(share) {
  const wiped = part("wiped");
  // A slider's thumb stays within it; the middle of a live one goes from 20 pixels to as many before the end.
  const inset = wiped.classList.contains("recorded") ? 0 : 20 / Math.max(wiped.clientWidth, 41);
  const border = inset + share * (1 - 2 * inset);
  wiped.style.setProperty("--border", `${100 * border}%`);
  return border;
}

const digits = (value, count) => (Number.isFinite(value) ? value.toFixed(count) : "–");
export const milliseconds = (value) => digits(value, value < 10 ? 2 : 1);
const small = (value) => (Number.isFinite(value) ? value.toPrecision(3) : "–");

/** The table of methods: `rows` are `[name, milliseconds, scores]`, the last two where they are known. */
export function figures(rows, seen) {
  const lines = rows.map(([name, time, scores]) => {
    const line = document.createElement("tr");
    line.classList.toggle("seen", seen.includes(name));
    const head = document.createElement("th");
    head.textContent = name;
    line.append(head);
    const cells = [
      ["ms", milliseconds(time)],
      ["ssim", digits(scores?.ssim, 4)],
      ["relmse", small(scores?.relative_mse)],
      ["psnr", digits(scores?.psnr, 2)],
      ["flip", digits(scores?.flip, 4)],
    ];
    for (const [kind, text] of cells) {
      const cell = line.insertCell();
      cell.textContent = text;
      cell.dataset.figure = `${name}.${kind}`;
    }
    return line;
  });
  part("figures").tBodies[0].replaceChildren(...lines);
}

/** The passes of a frame, in order. */
export function passes(names, times) {
  const lines = names.map((name, index) => {
    const line = document.createElement("tr");
    const head = document.createElement("th");
    head.textContent = name;
    line.append(head);
    line.insertCell().textContent = milliseconds(times?.[index]);
    return line;
  });
  part("passes").tBodies[0].replaceChildren(...lines);
}

/** Facts below the comparison: `[what, value]` each. */
export function facts(all) {
  const lines = all.map(([what, value]) => {
    const line = document.createElement("div");
    const term = document.createElement("dt");
    const text = document.createElement("dd");
    term.textContent = what;
    text.textContent = value;
    line.append(term, text);
    return line;
  });
  part("facts").replaceChildren(...lines);
}

/** Sentences below everything. */
export function notes(all) {
  const list = document.createElement("ul");
  list.replaceChildren(
    ...all.map((text) => {
      const line = document.createElement("li");
      line.textContent = text;
      return line;
    }),
  );
  part("notes").replaceChildren(list);
}
