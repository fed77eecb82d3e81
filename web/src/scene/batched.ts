/** One mesh at many places: the steps of a path. */
import { type BufferGeometry, InstancedMesh, Matrix4, MeshLambertMaterial, Quaternion, Vector3 } from "three";
import type { SceneNode } from "../state/scene";
import { ink } from "./ink";

export function batched(props: SceneNode["props"], geometry: BufferGeometry): InstancedMesh {
  const positions = numbersOf(props["batched_positions"]);
  const turns = numbersOf(props["batched_wxyzs"]);
  const sizes = numbersOf(props["batched_scales"]);
  const colors = numbersOf(props["batched_colors"]);
  const count = Math.floor(positions.length / 3);
  const mesh = new InstancedMesh(geometry, new MeshLambertMaterial(), count);
  const matrix = new Matrix4();
  for (let i = 0; i < count; i += 1) {
    const [w = 1, x = 0, y = 0, z = 0] = turns.slice(i * 4, i * 4 + 4);
    matrix.compose(at(positions, i), new Quaternion(x, y, z, w), sizeOf(sizes, i, count));
    mesh.setMatrixAt(i, matrix);
    const own = colors.length >= count * 3 ? i * 3 : 0;
    mesh.setColorAt(i, ink(colors.slice(own, own + 3)));
  }
  return mesh;
}

/** Where an instance is, in the node's own frame. */
export function at(positions: ArrayLike<number>, i: number): Vector3 {
  return new Vector3(positions[i * 3] ?? 0, positions[i * 3 + 1] ?? 0, positions[i * 3 + 2] ?? 0);
}

function sizeOf(sizes: number[], i: number, count: number): Vector3 {
  if (sizes.length === count * 3 && count > 0) return at(sizes, i);
  const size = sizes[i] ?? 1;
  return new Vector3(size, size, size);
}

function numbersOf(value: unknown): number[] {
  return ArrayBuffer.isView(value) ? Array.from(value as Float32Array) : Array.isArray(value) ? value.map(Number) : [];
}
