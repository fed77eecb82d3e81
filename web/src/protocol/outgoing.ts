/** What this client says: one msgpack map a websocket message. */
import { encode } from "@msgpack/msgpack";

export type Vector2 = [number, number];
export type Vector3 = [number, number, number];

/** A control has a new value. */
export interface GuiUpdate {
  type: "GuiUpdateMessage";
  uuid: string;
  updates: { value: unknown };
}

/** Something clickable in the scene was clicked. */
export interface SceneNodeClick {
  type: "SceneNodeClickMessage";
  name: string;
  instance_index: number | null;
  ray_origin: Vector3;
  ray_direction: Vector3;
  /** From 0 to 1, from the upper left. */
  screen_pos: Vector2;
  modifier: string | null;
  owner: string;
}

export type Outgoing = GuiUpdate | SceneNodeClick;

/** A message to send. */
export interface Letter {
  message: Outgoing;
  /** The server always says something to it, so that silence means that it is gone. */
  answered: boolean;
}

export function encodeMessage(message: Outgoing): Uint8Array<ArrayBuffer> {
  return encode(message);
}

export function guiUpdate(uuid: string, value: unknown): GuiUpdate {
  return { type: "GuiUpdateMessage", uuid, updates: { value } };
}
