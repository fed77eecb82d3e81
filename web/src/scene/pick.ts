/** Which instance of a clickable node is under a pointer: the nearest on the screen, so that fingers can hit it too. */
import { type Camera, Raycaster, Vector2, Vector3 } from "three";
import type { Object3D } from "three";
import type { SceneNode } from "../state/scene";
import { at } from "./batched";
import { floats } from "./content";

export interface Hit {
  name: string;
  instance: number;
  ray: { origin: number[]; direction: number[] };
  /** From 0 to 1, from the upper left. */
  screen: [number, number];
}

const REACH_PX = 14;

export function pick(
  nodes: Iterable<SceneNode>,
  objects: ReadonlyMap<string, Object3D>,
  camera: Camera,
  x: number,
  y: number,
  width: number,
  height: number,
): Hit | undefined {
  let best: { name: string; instance: number } | undefined;
  let nearest = REACH_PX;
  const point = new Vector3();
  for (const node of nodes) {
    const object = objects.get(node.name);
    if (!node.clickable || !node.visible || object === undefined || node.type !== "BatchedMeshesMessage") continue;
    const positions = floats(node.props["batched_positions"]);
    for (let i = 0; i * 3 + 2 < positions.length; i += 1) {
      point.copy(at(positions, i)).applyMatrix4(object.matrixWorld).project(camera);
      if (point.z > 1) continue;
      const away = Math.hypot(((point.x + 1) / 2) * width - x, ((1 - point.y) / 2) * height - y);
      if (away < nearest) {
        nearest = away;
        best = { name: node.name, instance: i };
      }
    }
  }
  if (best === undefined) return undefined;
  const caster = new Raycaster();
  caster.setFromCamera(new Vector2((x / width) * 2 - 1, 1 - (y / height) * 2), camera);
  return {
    ...best,
    ray: { origin: caster.ray.origin.toArray(), direction: caster.ray.direction.toArray() },
    screen: [x / width, y / height],
  };
}
