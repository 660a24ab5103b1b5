// The floor with its grid and the sky that it fades into.
import {
  BackSide, CircleGeometry, Color, Group, Mesh, ShaderMaterial, ShadowMaterial, SphereGeometry,
  Vector2,
} from "three";

export const THEMES = {
  dark: { sky: "#20242c", horizon: "#3a414d", floor: "#2b3038", line: "#aab4c4", shadow: 0.55 },
  light: { sky: "#dfe7f1", horizon: "#f6f8fb", floor: "#e9edf2", line: "#5a6677", shadow: 0.4 },
};

const FLOOR_VERTEX = `
varying vec2 place;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  place = world.xy;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

// Lines are as wide in pixels near and far, and vanish where they would come too close together.
const FLOOR_FRAGMENT = `
varying vec2 place;
uniform vec3 floorColor, lineColor, horizon;
uniform vec2 center;
uniform float unit, far, ground;
float grid(float spacing, float width) {
  vec2 cell = place / spacing;
  vec2 pixel = fwidth(cell);
  vec2 apart = abs(fract(cell - 0.5) - 0.5) / max(pixel, 1e-6);
  vec2 share = (1.0 - min(apart / width, 1.0)) * clamp(0.6 - pixel * 1.2, 0.0, 1.0);
  return max(share.x, share.y);
}
void main() {
  float near = smoothstep(far, far * 0.12, length(place - center));
  vec2 axis = 1.0 - min(abs(place) / fwidth(place) / 1.4, 1.0);
  float line = max(grid(unit, 1.2) * 0.55, grid(unit * 0.1, 1.0) * 0.1);
  vec3 color = mix(floorColor, lineColor, line * near * 0.7);
  color = mix(color, vec3(0.85, 0.25, 0.25), axis.y * near * 0.75);
  color = mix(color, vec3(0.25, 0.7, 0.35), axis.x * near * 0.75);
  gl_FragColor = vec4(mix(horizon, color, near), 1.0);
  #include <colorspace_fragment>
}`;

const SKY_VERTEX = `
varying vec3 direction;
void main() {
  direction = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const SKY_FRAGMENT = `
varying vec3 direction;
uniform vec3 sky, horizon;
void main() {
  float height = normalize(direction).z;
  gl_FragColor = vec4(mix(horizon, sky, smoothstep(0.0, 0.45, height)), 1.0);
  #include <colorspace_fragment>
}`;

const uniforms = (values) =>
  Object.fromEntries(Object.entries(values).map(([key, value]) => [key, { value }]));

/** Floor and sky around a robot of this size, m. */
export class Ground {
  constructor(size) {
    this.node = new Group();
    // Lines 0.1, 1 or 10 m apart, by the robot's size.
    this.unit = 10 ** Math.round(Math.log10(size));
    const far = size * 14;
    const disc = new CircleGeometry(far, 64);
    this.floor = new Mesh(disc, new ShaderMaterial({
      vertexShader: FLOOR_VERTEX,
      fragmentShader: FLOOR_FRAGMENT,
      uniforms: uniforms({
        floorColor: new Color(), lineColor: new Color(), horizon: new Color(),
        center: new Vector2(), unit: this.unit, far,
      }),
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.shadow = new Mesh(disc, new ShadowMaterial({ depthWrite: false }));
    this.shadow.receiveShadow = true;
    this.sky = new Mesh(new SphereGeometry(size * 150, 32, 16), new ShaderMaterial({
      vertexShader: SKY_VERTEX,
      fragmentShader: SKY_FRAGMENT,
      uniforms: uniforms({ sky: new Color(), horizon: new Color() }),
      side: BackSide,
      depthWrite: false,
    }));
    this.sky.renderOrder = -2;
    this.node.add(this.sky, this.floor, this.shadow);
  }

  theme({ sky, horizon, floor, line, shadow }) {
    const { uniforms: ground } = this.floor.material;
    ground.floorColor.value.set(floor);
    ground.lineColor.value.set(line);
    ground.horizon.value.set(horizon);
    this.sky.material.uniforms.sky.value.set(sky);
    this.sky.material.uniforms.horizon.value.set(horizon);
    this.shadow.material.opacity = shadow;
  }

  /** Floor below `center`, sky about the camera. */
  follow(center, camera) {
    for (const disc of [this.floor, this.shadow]) disc.position.set(center.x, center.y, 0);
    this.floor.material.uniforms.center.value.set(center.x, center.y);
    this.sky.position.copy(camera);
  }
}
