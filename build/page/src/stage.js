// Camera, light and renderer. The only module that needs WebGL.
import {
  Box3, DirectionalLight, HemisphereLight, MathUtils, NeutralToneMapping, Object3D, PCFShadowMap,
  PerspectiveCamera, PMREMGenerator, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { RoomEnvironment } from "three/examples/jsm/environments/RoomEnvironment.js";
import { Ground, THEMES } from "./ground.js";
import { reducedMotion } from "./dom.js";

Object3D.DEFAULT_UP.set(0, 0, 1);

/** From the robot to the camera at the beginning. */
const HOME = new Vector3(1, -1.35, 0.55).normalize();

/** What is left out, step by step, where a frame takes too long. */
const QUALITY = [
  { pixels: 1, shadow: 2048, coat: 0.4 },
  { pixels: 1, shadow: 1024, coat: 0 },
  { pixels: 0.7, shadow: 1024, coat: 0 },
  { pixels: 0.5, shadow: 0, coat: 0 },
];

export class Stage {
  constructor(canvas, robot, size, ground, quality) {
    Object.assign(this, { canvas, robot, size, quality: 0, last: new Vector3() });
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    this.scene = new Scene();
    this.#surroundings(quality);

    this.camera = new PerspectiveCamera(35, 1, size * 0.02, size * 400);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !reducedMotion();
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    // Never far below the ground.
    this.controls.maxPolarAngle = ground ? Math.PI * 0.52 : Math.PI;
    this.controls.minDistance = size * 0.3;
    this.controls.maxDistance = size * 60;

    this.#light(size);
    this.ground = new Ground(size);
    if (!ground) this.ground.floor.visible = this.ground.shadow.visible = false;
    this.scene.add(this.ground.node, robot.root);
    this.raycaster = new Raycaster();
    if (quality) this.lower(quality);
  }

  /** Light from all around: that of a room, or an even one where drawing the room is too slow. */
  #surroundings(quality) {
    if (quality >= QUALITY.length - 1) {
      this.scene.add(new HemisphereLight("#ffffff", "#8d99a8", 1.6));
      return;
    }
    const generator = new PMREMGenerator(this.renderer);
    this.scene.environment = generator.fromScene(new RoomEnvironment(), 0.04).texture;
    this.scene.environmentIntensity = 0.55;
    this.scene.environmentRotation.set(Math.PI / 2, 0, 0);
    generator.dispose();
  }

  /** The sun stands well beside the camera: from behind it no shadow would be seen. */
  #light(size) {
    this.sun = new DirectionalLight("#fff6e8", 2.6);
    this.fill = new DirectionalLight("#a8c4ff", 0.5);
    const { shadow } = this.sun;
    this.sun.castShadow = true;
    shadow.mapSize.setScalar(QUALITY[0].shadow);
    shadow.radius = 5;
    shadow.bias = -0.0004;
    shadow.normalBias = size * 0.004;
    const reach = size * 1.6;
    Object.assign(shadow.camera, {
      left: -reach, right: reach, top: reach, bottom: -reach, near: size * 0.1, far: size * 8,
    });
    shadow.camera.updateProjectionMatrix();
    this.scene.add(this.sun, this.sun.target, this.fill, this.fill.target);
  }

  theme(name) {
    this.ground.theme(THEMES[name]);
  }

  /** Looks at a box from the front, so that it fills the view but for `margin` pixels at the top. */
  home(box, margin) {
    const center = box.getCenter(new Vector3());
    const radius = Math.max(box.getSize(new Vector3()).length() / 2, this.size * 0.2);
    const portrait = Math.min(Math.max(1 / this.camera.aspect, 1), 1.6);
    const distance = radius / Math.sin(MathUtils.degToRad(this.camera.fov / 2)) * portrait;
    this.controls.target.copy(center);
    const free = Math.max(1 - 2 * margin / Math.max(this.canvas.clientHeight, 1), 0.5);
    this.camera.position.copy(center).addScaledVector(HOME, distance * Math.max(1.05, 1 / free));
    this.controls.update();
  }

  /** Turns, tilts and zooms by keys; angles in rad. */
  turn(around, up, zoom) {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const flat = Math.hypot(arm.x, arm.y);
    const azimuth = Math.atan2(arm.y, arm.x) + around;
    const height = MathUtils.clamp(Math.atan2(arm.z, flat) + up, -0.05, 1.5);
    const length = MathUtils.clamp(arm.length() * zoom, this.size * 0.3, this.size * 60);
    arm.set(Math.cos(azimuth) * Math.cos(height), Math.sin(azimuth) * Math.cos(height),
      Math.sin(height)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }

  /** Moves the camera with the base. */
  follow(on) {
    const { position } = this.robot.base.node;
    if (on) {
      const step = position.clone().sub(this.last);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.last.copy(position);
  }

  draw() {
    this.controls.update();
    const center = this.robot.base.node.position;
    const { size } = this;
    this.sun.position.copy(center).add(new Vector3(-1.1, -1.9, 2.9).multiplyScalar(size));
    this.sun.target.position.copy(center);
    this.fill.position.copy(center).add(new Vector3(3, 0.6, 1.2).multiplyScalar(size));
    this.fill.target.position.copy(center);
    this.ground.follow(center, this.camera.position);
    this.renderer.render(this.scene, this.camera);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const { pixels } = QUALITY[this.quality];
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * pixels);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Draws with less where the machine is slow; false where nothing is left to leave out. */
  lower(level = this.quality + 1) {
    if (level >= QUALITY.length) return false;
    this.quality = level;
    const { shadow, coat } = QUALITY[level];
    for (const material of this.robot.materials.values()) {
      material.clearcoat = coat;
      material.needsUpdate = true;
    }
    this.renderer.shadowMap.enabled = shadow > 0;
    if (shadow) this.sun.shadow.mapSize.setScalar(shadow);
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
    this.ground.shadow.material.needsUpdate = true;
    this.resize();
    return true;
  }

  /** What of the robot is under the pointer: link and point; undefined where nothing is. */
  pick(event) {
    this.#aim(event);
    const [hit] = this.raycaster.intersectObjects(this.robot.bodies, false);
    return hit && { link: hit.object.userData.link, point: hit.point };
  }

  /** Where the pointer's ray meets a plane. */
  meet(event, plane, into) {
    this.#aim(event);
    return this.raycaster.ray.intersectPlane(plane, into);
  }

  #aim(event) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - left) / width) * 2 - 1;
    const y = 1 - ((event.clientY - top) / height) * 2;
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
  }
}

/** The box around a robot throughout a run, from some of its poses. */
export function reach(robot, run, samples = 24) {
  const whole = new Box3();
  for (let i = 0; i <= samples; i++) {
    run.locate(run.start + ((run.end - run.start) * i) / samples);
    robot.pose(run);
    whole.union(robot.box(new Box3()));
  }
  return whole;
}
