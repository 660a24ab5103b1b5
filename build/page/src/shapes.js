// Geometries of a scene's shapes.
import {
  BufferAttribute, BufferGeometry, CapsuleGeometry, LatheGeometry, SphereGeometry, Vector2,
} from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";

/** Share of the shortest side by which edges are rounded: they catch light, as real ones do. */
const BEVEL = 0.05;

/** Triangles that meet at less than this are one surface, rad (about 34°). */
const CREASE = 0.6;

/** A cylinder along z. */
function cylinder(radius, length) {
  const bevel = Math.min(radius, length) * BEVEL;
  const steps = 4;
  const profile = [new Vector2(0, -length / 2)];
  for (const [side, from] of [[-1, 0], [1, Math.PI / 2]]) {
    for (let i = 0; i <= steps; i++) {
      const angle = from + (i / steps) * (Math.PI / 2);
      profile.push(new Vector2(
        radius - bevel + bevel * Math.sin(angle),
        side * (length / 2 - bevel) - bevel * Math.cos(angle),
      ));
    }
  }
  profile.push(new Vector2(0, length / 2));
  return toCreasedNormals(new LatheGeometry(profile, 64), CREASE).rotateX(Math.PI / 2);
}

/** Vertices of a mesh block, in the link's units. */
export function vertices(mesh, body) {
  const count = mesh.vertices * 3;
  const packed = new Uint16Array(body.slice(mesh.at, mesh.at + count * 2).buffer);
  return Float32Array.from(packed, (n, i) => mesh.low[i % 3] + (n / 65535) * mesh.size[i % 3]);
}

function triangles(mesh, body) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(vertices(mesh, body), 3));
  let at = mesh.at + Math.ceil((mesh.vertices * 6) / 4) * 4;
  if (mesh.uv) {
    const [low, size] = mesh.uv;
    const packed = new Uint16Array(body.slice(at, at + mesh.vertices * 4).buffer);
    const uv = Float32Array.from(packed, (n, i) => low[i % 2] + (n / 65535) * size[i % 2]);
    geometry.setAttribute("uv", new BufferAttribute(uv, 2));
    at += mesh.vertices * 4;
  }
  const [Numbers, bytes] = mesh.vertices > 65536 ? [Uint32Array, 4] : [Uint16Array, 2];
  const places = new Numbers(body.slice(at, at + mesh.triangles * 3 * bytes).buffer);
  geometry.setIndex(new BufferAttribute(places, 1));
  return toCreasedNormals(geometry, CREASE);
}

/** Makes geometries; equal meshes share one. */
export function maker({ head, body }) {
  const meshes = new Map();
  return ({ shape }) => {
    if (shape.box) {
      return new RoundedBoxGeometry(...shape.box, 3, Math.min(...shape.box) * BEVEL);
    }
    if (shape.sphere !== undefined) return new SphereGeometry(shape.sphere, 48, 32);
    if (shape.cylinder) return cylinder(...shape.cylinder);
    if (shape.capsule) {
      return new CapsuleGeometry(...shape.capsule, 16, 32).rotateX(Math.PI / 2);
    }
    if (!meshes.has(shape.mesh)) {
      meshes.set(shape.mesh, triangles(head.meshes[shape.mesh], body));
    }
    return meshes.get(shape.mesh);
  };
}
