/** From a node's props to what three draws. Lengths are metres, +Z is up; the pose is not of this file. */
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  IcosahedronGeometry,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
  Quaternion,
  Vector3,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { SceneNode } from "../state/scene";
import { batched } from "./batched";
import { colorOf, ink } from "./ink";

type Props = SceneNode["props"];
type Maker = (props: Props) => Object3D;

const MAKERS: Record<string, Maker> = {
  BoxMessage: (props) => {
    const [x = 1, y = 1, z = 1] = numbers(props["dimensions"]);
    return solid(new BoxGeometry(x, y, z), props);
  },
  IcosphereMessage: (props) =>
    solid(new IcosahedronGeometry(number(props["radius"], 1), Math.min(4, number(props["subdivisions"], 3))), props),
  CylinderMessage: (props) => {
    const radius = number(props["radius"], 1);
    const geometry = new CylinderGeometry(
      radius,
      radius,
      number(props["height"], 1),
      number(props["radial_segments"], 32),
    );
    return solid(geometry.rotateX(Math.PI / 2), props);
  },
  MeshMessage: (props) => solid(meshGeometry(props), props),
  BatchedMeshesMessage: (props) => batched(props, meshGeometry(props)),
  LineSegmentsMessage: lines,
  ArrowMessage: arrows,
  GridMessage: grid,
};

/** What a node shows; nothing for groups, labels and what this page does not draw. */
export function contentOf(node: SceneNode): Object3D | undefined {
  const maker = node.type === undefined ? undefined : MAKERS[node.type];
  const content = maker?.(node.props);
  const scale = node.props["scale"];
  if (typeof scale === "number") content?.scale.setScalar(scale);
  return content;
}

/** Frees what the graphics card holds for it. */
export function dispose(content: Object3D): void {
  content.traverse((object) => {
    const { geometry, material } = object as Partial<Mesh>;
    geometry?.dispose();
    [material ?? []].flat().forEach((each) => each.dispose());
  });
}

function solid(geometry: BufferGeometry, props: Props): Mesh {
  const opacity = typeof props["opacity"] === "number" ? props["opacity"] : 1;
  const material = new MeshLambertMaterial({
    color: colorOf(props["color"]),
    opacity,
    transparent: opacity < 1,
    depthWrite: opacity >= 1,
    wireframe: props["wireframe"] === true,
    flatShading: props["flat_shading"] === true,
    side: DoubleSide,
  });
  return new Mesh(geometry, material);
}

function meshGeometry(props: Props): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(floats(props["vertices"]), 3));
  const faces = props["faces"];
  if (faces instanceof Uint32Array) geometry.setIndex(new BufferAttribute(faces, 1));
  geometry.computeVertexNormals();
  return geometry;
}

function lines(props: Props): Object3D {
  const points = floats(props["points"]);
  if (points.length < 6) return new Group();
  const geometry = new LineSegmentsGeometry().setPositions(points);
  const given = bytes(props["colors"]);
  const perPoint = given.length === points.length;
  if (perPoint) geometry.setColors(linear(given));
  const world = props["thickness_units"] !== "screen";
  const material = new LineMaterial({
    color: perPoint ? 0xffffff : ink(given.subarray(0, 3)),
    vertexColors: perPoint,
    worldUnits: world,
    linewidth: number(props["thickness"], 0.01),
  });
  return new LineSegments2(geometry, material);
}

function arrows(props: Props): Object3D {
  const points = floats(props["points"]);
  const given = bytes(props["colors"]);
  const [shaft, head, length] = [
    number(props["shaft_radius"], 0.02),
    number(props["head_radius"], 0.05),
    number(props["head_length"], 0.1),
  ];
  const group = new Group();
  for (let i = 0; i * 6 + 5 < points.length; i += 1) {
    const from = new Vector3(...points.subarray(i * 6, i * 6 + 3));
    const along = new Vector3(...points.subarray(i * 6 + 3, i * 6 + 6)).sub(from);
    const whole = along.length();
    if (!(whole > 1e-6)) continue;
    const own =
      given.length >= (i + 1) * 3 && given.length > 3 ? given.subarray(i * 3, i * 3 + 3) : given.subarray(0, 3);
    const tip = Math.min(length, whole * 0.6);
    const material = new MeshLambertMaterial({ color: ink(own) });
    const stem = new CylinderGeometry(shaft, shaft, whole - tip, 12).translate(0, (whole - tip) / 2, 0);
    const cone = new ConeGeometry(head, tip, 16).translate(0, whole - tip / 2, 0);
    const arrow = new Group().add(new Mesh(stem, material), new Mesh(cone, material));
    arrow.position.copy(from);
    arrow.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.divideScalar(whole)));
    group.add(arrow);
  }
  return group;
}

/** A net of lines in the xy plane, the sections over the cells. */
function grid(props: Props): Object3D {
  const [width, height] = [number(props["width"], 10), number(props["height"], 10)];
  const net = (step: number, color: unknown) => {
    const ends: number[] = [];
    if (step > 0 && (width + height) / step < 2000) {
      for (let x = Math.ceil(-width / 2 / step) * step; x <= width / 2 + 1e-9; x += step)
        ends.push(x, -height / 2, 0, x, height / 2, 0);
      for (let y = Math.ceil(-height / 2 / step) * step; y <= height / 2 + 1e-9; y += step)
        ends.push(-width / 2, y, 0, width / 2, y, 0);
    }
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
    return new LineSegments(
      geometry,
      new LineBasicMaterial({ color: colorOf(color), transparent: true, opacity: 0.5 }),
    );
  };
  return new Group().add(
    net(number(props["cell_size"], 0.5), props["cell_color"]),
    net(number(props["section_size"], 1), props["section_color"]),
  );
}

/** Colours of vertices in three's own working space. */
function linear(given: Uint8Array): Float32Array {
  const out = new Float32Array(given.length);
  for (let i = 0; i + 2 < given.length; i += 3) {
    const color = ink(given.subarray(i, i + 3));
    out.set([color.r, color.g, color.b], i);
  }
  return out;
}

function number(value: unknown, otherwise: number): number {
  return typeof value === "number" && Number.isFinite(value) ? value : otherwise;
}

function numbers(value: unknown): number[] {
  return Array.isArray(value) ? value.filter((n): n is number => typeof n === "number") : [];
}

export function floats(value: unknown): Float32Array {
  return value instanceof Float32Array ? value : new Float32Array();
}

export function bytes(value: unknown): Uint8Array {
  return value instanceof Uint8Array ? value : new Uint8Array();
}
