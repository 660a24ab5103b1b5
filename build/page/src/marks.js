// What is drawn about the robot: arrows for forces, the path of the base, frames of links.
import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, Group, Line, LineBasicMaterial,
  Mesh, MeshBasicMaterial, MeshLambertMaterial, Vector3,
} from "three";

const UP = new Vector3(0, 0, 1);
const shaftShape = new CylinderGeometry(0.5, 0.5, 1, 16).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const tipShape = new ConeGeometry(1.25, 1, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5);

/** An arrow. Where the robot hides it, it shines through faintly. */
export class Arrow {
  constructor(color, size) {
    this.size = size;
    this.node = new Group();
    this.node.visible = false;
    const solid = new MeshLambertMaterial({
      color, emissive: color, emissiveIntensity: 0.35, toneMapped: false,
    });
    const faint = new MeshBasicMaterial({
      color, transparent: true, opacity: 0.3, depthTest: false, depthWrite: false,
      toneMapped: false,
    });
    [this.shaft, this.tip] = [shaftShape, tipShape].map((shape) => {
      const part = new Mesh(shape, solid);
      const through = new Mesh(shape, faint);
      through.renderOrder = 5;
      part.add(through);
      this.node.add(part);
      return part;
    });
    this.direction = new Vector3();
  }

  hide() {
    this.node.visible = false;
  }

  /** From a point along a vector, `length` m long. */
  show(from, along, length) {
    this.node.visible = length > this.size * 0.012;
    if (!this.node.visible) return;
    const width = this.size * 0.014;
    const head = Math.min(width * 3.2, length / 2);
    this.node.position.copy(from);
    this.node.quaternion.setFromUnitVectors(UP, this.direction.copy(along).normalize());
    this.shaft.scale.set(width, width, length - head);
    this.tip.scale.set(width, width, head);
    this.tip.position.z = length - head;
  }
}

/** Points of the path that are drawn, at most. */
const PATH_POINTS = 3000;

/** The way of the base's origin over the ground, up to now. */
export class Path {
  constructor(position, size) {
    this.variables = position.variables;
    this.height = size * 0.004;
    this.node = new Line(new BufferGeometry(), new LineBasicMaterial({
      color: "#f0883e", transparent: true, opacity: 0.9, toneMapped: false,
    }));
    this.node.frustumCulled = false;
  }

  update(run) {
    const [x, y] = this.variables.map((name) => run.columns.get(name));
    this.node.visible = Boolean(x && y && run.rows);
    if (!this.node.visible) return;
    const rows = run.row + 1;
    const stride = Math.max(1, Math.ceil(rows / PATH_POINTS));
    const points = [];
    for (let row = 0; row < rows; row += stride) points.push(x[row], y[row], this.height);
    const [nowX, nowY] = this.variables.map((name) => run.value(name) ?? 0);
    points.push(nowX, nowY, this.height);
    this.node.geometry.dispose();
    this.node.geometry = new BufferGeometry();
    this.node.geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  }
}

const axisShape = new CylinderGeometry(1, 1, 1, 8).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const AXES = [["#e5484d", [1, 0, 0]], ["#3fae5a", [0, 1, 0]], ["#3b82f6", [0, 0, 1]]];

/** The axes of a link's frame: x red, y green, z blue, seen through everything. */
export function frame(length) {
  const node = new Group();
  for (const [color, direction] of AXES) {
    const axis = new Mesh(axisShape, new MeshBasicMaterial({
      color, depthTest: false, toneMapped: false, transparent: true,
    }));
    axis.quaternion.setFromUnitVectors(UP, new Vector3(...direction));
    axis.scale.set(length * 0.03, length * 0.03, length);
    axis.renderOrder = 9;
    node.add(axis);
  }
  node.visible = false;
  return node;
}
