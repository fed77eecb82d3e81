/** The nodes of the 3-D scene, by path. */
import type { Message } from "../protocol/frame";
import { mapOf } from "./gui";

export interface SceneNode {
  /** A path: `/table/plate` is in the frame of `/table`. */
  name: string;
  /** The message's type: `BoxMessage`; nothing where only its pose is known so far. */
  type: string | undefined;
  owner: string;
  props: Readonly<Record<string, unknown>>;
  position: readonly number[];
  /** w, x, y, z. */
  wxyz: readonly number[];
  visible: boolean;
  clickable: boolean;
}

const CREATED = new Set(
  (
    "Frame Box Icosphere Cylinder Mesh BatchedMeshes PointCloud LineSegments Arrow CatmullRomSpline CubicBezierSpline " +
    "BatchedAxes Grid Label Image CameraFrustum DirectionalLight AmbientLight HemisphereLight PointLight RectAreaLight " +
    "SpotLight Glb BatchedGlb SkinnedMesh GaussianSplats TransformControls Gui3D"
  )
    .split(" ")
    .map((name) => `${name}Message`),
);

/** Applies a message about a node; returns the names it touched, or nothing where it is not about one. */
export function applyScene(nodes: Map<string, SceneNode>, message: Message): string[] | undefined {
  const { type, name } = message;
  if (typeof name !== "string") return undefined;
  const old = nodes.get(name);
  if (CREATED.has(type)) {
    // A name that is sent again keeps its pose, its visibility and its clicks.
    const node = old ?? blank(name);
    nodes.set(name, { ...node, type, props: mapOf(message["props"]) ?? {}, owner: textOr(message["owner"], "") });
    return [name];
  }
  switch (type) {
    case "RemoveSceneNodeMessage":
      return remove(nodes, name);
    case "SceneNodeUpdateMessage":
      if (old !== undefined) {
        nodes.set(name, { ...old, props: { ...old.props, ...mapOf(message["updates"]) } });
      }
      return [name];
    case "SetPositionMessage":
      nodes.set(name, { ...(old ?? blank(name)), position: numbersOr(message["position"], 3, [0, 0, 0]) });
      return [name];
    case "SetOrientationMessage":
      nodes.set(name, { ...(old ?? blank(name)), wxyz: numbersOr(message["wxyz"], 4, [1, 0, 0, 0]) });
      return [name];
    case "SetSceneNodeVisibilityMessage":
      nodes.set(name, { ...(old ?? blank(name)), visible: message["visible"] === true });
      return [name];
    case "SetSceneNodeClickBindingsMessage": {
      const bindings = message["bindings"];
      nodes.set(name, { ...(old ?? blank(name)), clickable: Array.isArray(bindings) && bindings.length > 0 });
      return [name];
    }
    default:
      return undefined;
  }
}

/** A node goes with everything below it. */
function remove(nodes: Map<string, SceneNode>, name: string): string[] {
  const gone = [...nodes.keys()].filter((other) => other === name || other.startsWith(`${name}/`));
  gone.forEach((other) => nodes.delete(other));
  return gone;
}

function blank(name: string): SceneNode {
  return {
    name,
    type: undefined,
    owner: "",
    props: {},
    position: [0, 0, 0],
    wxyz: [1, 0, 0, 0],
    visible: true,
    clickable: false,
  };
}

function textOr(value: unknown, otherwise: string): string {
  return typeof value === "string" ? value : otherwise;
}

function numbersOr(value: unknown, count: number, otherwise: number[]): number[] {
  const fits = Array.isArray(value) && value.length === count && value.every((n) => Number.isFinite(n));
  return fits ? (value as number[]) : otherwise;
}
