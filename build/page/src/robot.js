// The robot and what is around it as trees of nodes: placing the nodes is the forward kinematics. Needs no WebGL.
import {
  Box3, Color, DoubleSide, FrontSide, Group, Mesh, MeshBasicMaterial, MeshPhysicalMaterial,
  Quaternion, RepeatWrapping, SRGBColorSpace, TextureLoader, Vector3,
} from "three";
import { maker } from "./shapes.js";

/** Opacity of the robot while something inside of it is shown. */
const FADED = 0.3;

/** Along what is drawn between two points. */
const UP = new Vector3(0, 0, 1);

export class Robot {
  constructor(scene) {
    const { head } = scene;
    this.root = new Group();
    this.links = head.links.map((link, i) => {
      const node = new Group();
      node.name = link.name;
      node.userData.link = i;
      return node;
    });
    this.bases = head.roots.map((base) => ({ node: new Group(), ...base }));
    for (const { node, link } of this.bases) {
      this.root.add(node);
      node.add(this.links[link]);
    }
    [this.base] = this.bases;
    this.motions = [];
    for (const joint of head.joints) {
      let node = new Group();
      node.position.fromArray(joint.position);
      node.quaternion.fromArray(joint.orientation);
      this.links[joint.parent].add(node);
      for (const motion of joint.motions) {
        const moved = new Group();
        node.add(moved);
        node = moved;
        this.motions.push({ node, motion, axis: new Vector3(...motion.axis) });
      }
      node.add(this.links[joint.child]);
    }
    this.materials = new Map();
    this.bodies = [];
    this.hulls = [];
    const geometry = maker(scene);
    const textures = head.textures.map((texture) => image(texture, scene.body));
    for (const drawn of head.visuals.length ? head.visuals : head.collisions) {
      this.bodies.push(this.#place(drawn, geometry(drawn), this.#material(drawn, textures)));
    }
    const collision = new MeshBasicMaterial({
      color: "#f0883e", transparent: true, opacity: 0.35, depthWrite: false, toneMapped: false,
    });
    for (const drawn of head.collisions) {
      const hull = this.#place(drawn, geometry(drawn), collision);
      hull.visible = false;
      this.hulls.push(hull);
    }
    this.ties = (head.ties ?? []).map(({ ends, ...drawn }) => {
      const mesh = new Mesh(geometry(drawn), this.#material(drawn, textures));
      mesh.name = drawn.name;
      this.root.add(mesh);
      return { mesh, ends, scale: drawn.scale ?? [1, 1, 1] };
    });
    for (const body of this.#seen()) body.castShadow = body.receiveShadow = true;
  }

  /** All that is seen. */
  #seen() {
    return [...this.bodies, ...this.ties.map(({ mesh }) => mesh)];
  }

  #place(drawn, geometry, material) {
    const mesh = new Mesh(geometry, material);
    mesh.position.fromArray(drawn.position);
    mesh.quaternion.fromArray(drawn.orientation);
    if (drawn.scale) mesh.scale.fromArray(drawn.scale);
    mesh.userData.link = drawn.link;
    this.links[drawn.link].add(mesh);
    return mesh;
  }

  #material({ color, texture, shape }, textures) {
    const mesh = shape.mesh !== undefined;
    const key = JSON.stringify([color, texture, mesh]);
    if (!this.materials.has(key)) {
      const [red, green, blue, alpha] = color;
      // Pure colours of a URDF are brighter than anything real: the range becomes a little
      // narrower. An image is taken as it is.
      const soft = (x) => (texture === undefined ? 0.045 + 0.855 * x : x);
      const material = new MeshPhysicalMaterial({
        color: new Color().setRGB(soft(red), soft(green), soft(blue), SRGBColorSpace),
        map: textures[texture] ?? null,
        roughness: 0.5,
        clearcoat: 0.4,
        clearcoatRoughness: 0.3,
        transparent: alpha < 1,
        opacity: alpha,
        side: mesh ? DoubleSide : FrontSide,
      });
      material.userData.opacity = alpha;
      this.materials.set(key, material);
    }
    return this.materials.get(key);
  }

  /** Makes the robot see-through, for frames and collision shapes. */
  fade(on) {
    for (const material of this.materials.values()) {
      const own = material.userData.opacity;
      material.opacity = on ? Math.min(own, FADED) : own;
      material.transparent = material.opacity < 1;
      material.depthWrite = !on;
      material.needsUpdate = true;
    }
  }

  /** Shows what touches the ground in the simulation. */
  showHulls(on) {
    for (const hull of this.hulls) hull.visible = on;
  }

  /** Places all links where they are in the run now. */
  pose(run) {
    for (const { node, position, orientation } of this.bases) {
      node.position.fromArray(run.numbers(position, []));
      node.quaternion.fromArray(run.quaternion(orientation, []));
    }
    for (const { node: moved, motion, axis } of this.motions) {
      if (motion.kind === "ball") {
        moved.quaternion.fromArray(run.quaternion(motion, []));
        continue;
      }
      const [x] = run.numbers(motion, []);
      if (motion.kind === "slide") moved.position.copy(axis).multiplyScalar(x);
      else moved.quaternion.setFromAxisAngle(axis, x);
    }
    this.root.updateMatrixWorld(true);
    for (const tie of this.ties) this.#stretch(tie);
  }

  /** Puts a rod or a spring between its ends: its z axis goes from the first to the second. */
  #stretch({ mesh, ends, scale: [x, y, z] }) {
    const [from, to] = ends.map(({ link, position }) => {
      const point = new Vector3(...position);
      return link === undefined ? point : point.applyMatrix4(this.links[link].matrixWorld);
    });
    const way = to.clone().sub(from);
    const length = way.length();
    mesh.position.copy(from).addScaledVector(way, 0.5);
    if (length > 0) mesh.quaternion.setFromUnitVectors(UP, way.divideScalar(length));
    mesh.scale.set(x, y, z * length);
    mesh.updateMatrixWorld(true);
  }

  /** The box around all that is seen, in the pose that it has. */
  box(into = new Box3()) {
    into.makeEmpty();
    for (const body of this.#seen()) into.expandByObject(body);
    if (into.isEmpty()) into.expandByPoint(this.base.node.position);
    return into;
  }

  /** Ends of all rods and springs by name, as they are drawn. */
  spans() {
    return Object.fromEntries(this.ties.map(({ mesh }) => {
      const ends = [-0.5, 0.5].map((z) => new Vector3(0, 0, z).applyMatrix4(mesh.matrixWorld));
      return [mesh.name, ends.map((end) => end.toArray())];
    }));
  }

  /** Positions and quaternions of all links by name, for whoever wants to compare them. */
  poses() {
    const position = new Vector3();
    const quaternion = new Quaternion();
    const scale = new Vector3();
    return Object.fromEntries(this.links.map((link) => {
      link.matrixWorld.decompose(position, quaternion, scale);
      return [link.name, [...position.toArray(), ...quaternion.toArray()]];
    }));
  }
}

function image({ at, bytes, kind }, body) {
  const address = URL.createObjectURL(new Blob([body.slice(at, at + bytes)], { type: kind }));
  const texture = new TextureLoader().load(address, () => dispatchEvent(new Event("redraw")));
  texture.colorSpace = SRGBColorSpace;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.anisotropy = 8;
  return texture;
}
