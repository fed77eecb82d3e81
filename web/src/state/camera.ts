/** Where the server wants a new viewer's camera. */
import type { Message } from "../protocol/frame";

export interface InitialCamera {
  position: [number, number, number] | undefined;
  lookAt: [number, number, number] | undefined;
  /** Vertical, radians. */
  fov: number | undefined;
}

/** The camera after a message; nothing where the message is not about one. */
export function applyCamera(camera: InitialCamera, message: Message): InitialCamera | undefined {
  switch (message.type) {
    case "SetCameraPositionMessage":
      return { ...camera, position: point(message["position"]) };
    case "SetCameraLookAtMessage":
      return { ...camera, lookAt: point(message["look_at"]) };
    case "SetCameraFovMessage":
      return { ...camera, fov: typeof message["fov"] === "number" ? message["fov"] : undefined };
    default:
      return undefined;
  }
}

function point(value: unknown): [number, number, number] | undefined {
  const fits = Array.isArray(value) && value.length === 3 && value.every((n) => Number.isFinite(n));
  return fits ? (value as [number, number, number]) : undefined;
}
