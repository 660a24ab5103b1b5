// Where contact forces are drawn, and how large the load of all contacts is over time.
import { Vector3 } from "three";
import { vertices } from "./shapes.js";

/** Points on a rim. */
const RIM = 16;

/** Points of a collision shape of which the lowest is where it touches the ground; link's frame. */
function points({ head, body }, drawn) {
  const { shape } = drawn;
  const list = [];
  if (shape.box) {
    for (let i = 0; i < 8; i++) {
      list.push(shape.box.map((side, axis) => (i >> axis & 1 ? side : -side) / 2));
    }
  } else if (shape.mesh !== undefined) {
    const flat = vertices(head.meshes[shape.mesh], body);
    for (let i = 0; i < flat.length; i += 3) list.push([flat[i], flat[i + 1], flat[i + 2]]);
  } else if (shape.cylinder) {
    const [radius, length] = shape.cylinder;
    for (let i = 0; i < 2 * RIM; i++) {
      const angle = (i / RIM) * 2 * Math.PI;
      const z = i < RIM ? length / 2 : -length / 2;
      list.push([radius * Math.cos(angle), radius * Math.sin(angle), z]);
    }
  } else {
    // A ball, or the balls at a capsule's ends, are their centres with a radius.
    const [radius, length] = shape.capsule ?? [shape.sphere, 0];
    for (const side of length ? [-1, 1] : [0]) list.push([0, 0, side * length / 2, radius]);
  }
  const mesh = { position: new Vector3(...drawn.position), turned: drawn.orientation };
  const scale = drawn.scale ?? [1, 1, 1];
  return list.map(([x, y, z, radius = 0]) => ({
    place: new Vector3(x * scale[0], y * scale[1], z * scale[2])
      .applyQuaternion({ x: mesh.turned[0], y: mesh.turned[1], z: mesh.turned[2],
        w: mesh.turned[3] })
      .add(mesh.position),
    radius,
  }));
}

export class Contacts {
  constructor(scene, robot, size) {
    this.robot = robot;
    this.tolerance = size * 0.004;
    this.list = scene.head.contacts.map((contact) => ({
      ...contact,
      points: scene.head.collisions
        .filter((drawn) => drawn.link === contact.link)
        .flatMap((drawn) => points(scene, drawn)),
    }));
  }

  /** Force of a contact now, N. */
  force(contact, run, into) {
    return into.set(...contact.force.map((name) => run.value(name) ?? 0));
  }

  /** Where it acts: the FMU's output, or the middle of the lowest points of the link. */
  point(contact, run, into) {
    const given = contact.point?.map((name) => run.value(name));
    if (given?.every((x) => Number.isFinite(x))) return into.set(...given);
    const { matrixWorld } = this.robot.links[contact.link];
    let lowest = Infinity;
    const placed = contact.points.map(({ place, radius }) => {
      const world = place.clone().applyMatrix4(matrixWorld);
      world.z -= radius;
      lowest = Math.min(lowest, world.z);
      return world;
    });
    const touching = placed.filter((place) => place.z <= lowest + this.tolerance);
    into.setFromMatrixPosition(matrixWorld);
    if (touching.length) {
      into.set(0, 0, 0);
      for (const place of touching) into.addScaledVector(place, 1 / touching.length);
    }
    into.z = Math.max(into.z, 0);
    return into;
  }

  /** Sum of the forces' sizes at a row, N. */
  load(run, row) {
    let sum = 0;
    for (const { force } of this.list) {
      const [x, y, z] = force.map((name) => run.columns.get(name)?.[row] || 0);
      sum += Math.hypot(x, y, z);
    }
    return sum;
  }
}
