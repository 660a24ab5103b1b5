// Elements, numbers and units as text. Names of a robot are any text: they become text nodes and
// attributes here, never markup.

export const byId = (id) => document.getElementById(id);

/** An element with properties, attributes (`aria-…`, `data-…`, `role`) and children. */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (/^(aria-|data-|role$|for$)/.test(key)) made.setAttribute(key, value);
    else made[key] = value;
  }
  made.append(...children);
  return made;
}

/** Text in which the names of keys stand in backticks. */
export function withKeys(text) {
  return text.split("`").map((part, i) =>
    (i % 2 ? element("kbd", { textContent: part }) : part));
}

/** A number with four digits. */
export function short(value) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) return value.toExponential(1);
  const text = size >= 1000 ? value.toFixed(0) : value.toPrecision(4);
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** A number with all digits that it has. */
export const exact = (value) => (Number.isFinite(value) ? String(value) : "–");

/** FMI's `N.m`, `m/s2` as they are written by hand. */
export function unit(name) {
  return name === "1" ? "" : name.replaceAll(".", "·").replace(/2$/, "²");
}

/** Colours of a theme that scripts need. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
