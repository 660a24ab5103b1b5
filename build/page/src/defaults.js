// Which plots a robot gets to begin with.

/** Curves in one plot, at most. */
const CURVES = 8;

/** Plots, at most; the rest is a tick away in the list of variables. */
const PLOTS = 14;

const sameEnd = (name, from, to) => name.replace(from, to);

/**
 * Titles, units and names of variables.
 *
 * @param has whether a variable has values
 */
export function defaultPlots({ head }, has) {
  const unitOf = new Map(head.variables.map((variable) => [variable.name, variable.unit]));
  const plots = [];
  const add = (title, names) => {
    const known = names.filter((name) => name && has(name));
    // Evenly, so that none is left over by itself, without its name.
    const parts = Math.ceil(known.length / CURVES);
    const size = Math.ceil(known.length / parts);
    for (let i = 0; i < known.length && plots.length < PLOTS; i += size) {
      const part = known.slice(i, i + size);
      const number = parts > 1 ? ` (${i / size + 1})` : "";
      plots.push({ title: title + number, unit: unitOf.get(part[0]) ?? "", names: part });
    }
  };
  const base = head.roots[0].position.variables;
  add("Base position", base);
  add("Base velocity", base.map((name) => sameEnd(name, /position(.[xyz])$/, "linear_velocity$1")));
  const angles = ["roll", "pitch", "yaw"];
  add("Base attitude",
    base.map((name, i) => sameEnd(name, /position(.)[xyz]$/, `rpy$1${angles[i]}`)));
  const moving = head.joints.filter((joint) => joint.motions.length);
  const driven = (kind) => moving.filter(({ variables }) => variables[`cmd.${kind}`]);
  const by = (joints, key) => joints.map(({ variables }) => variables[key]);
  const velocity = driven("velocity").filter(({ variables }) => !variables["cmd.position"]);
  const others = moving.filter((joint) => !velocity.includes(joint));
  add("Joint velocity", by(velocity, "velocity"));
  // Angles and lengths are different things.
  for (const [title, kind] of [["Joint angle", "turn"], ["Joint travel", "slide"]]) {
    const some = others.filter(({ motions }) => motions.length === 1 && motions[0].kind === kind);
    add(title, by(some, "position"));
  }
  add("Vertical contact force", head.contacts.map(({ force }) => force[2]));
  const powered = moving.filter(({ variables }) =>
    Object.keys(variables).some((key) => key.startsWith("cmd.")));
  for (const [title, kind] of [["Joint torque", "turn"], ["Joint force", "slide"]]) {
    const some = powered.filter(({ motions }) => motions[0].kind === kind);
    add(title, by(some, "effort"));
  }
  add("Energy", head.variables.filter(({ causality, unit }) =>
    causality === "output" && unit === "J").map(({ name }) => name));
  return plots;
}

/**
 * What names do not share: `joint.left_wheel.velocity` and `joint.right_wheel.velocity` are `left`
 * and `right`.
 */
export function shortNames(names) {
  if (names.length < 2) return names;
  const parts = names.map((name) => name.split(/(?=[._])/));
  const least = Math.min(...parts.map((list) => list.length));
  const shared = (at) => parts.every((list) => list.at(at) === parts[0].at(at));
  let first = 0;
  while (first < least - 1 && shared(first)) first += 1;
  let last = 0;
  while (last < least - 1 - first && shared(-1 - last)) last += 1;
  return parts.map((list) => list.slice(first, list.length - last).join("").replace(/^[._]/, ""));
}
