/** Notifications: errors, and progress of what takes long. */
import type { Message } from "../protocol/frame";
import { mapOf } from "./gui";

export interface Notice {
  uuid: string;
  title: string;
  body: string;
  /** Something is under way. */
  loading: boolean;
  /** Whether it is red: something went wrong. */
  error: boolean;
  /** When it goes by itself, in seconds; nothing where it stays. */
  autoCloseSecs: number | undefined;
}

/** Applies a message about a notification; whether it was one. */
export function applyNotice(notices: Map<string, Notice>, message: Message): boolean {
  const { type, uuid } = message;
  if (typeof uuid !== "string") return false;
  if (type === "RemoveNotificationMessage") {
    notices.delete(uuid);
    return true;
  }
  if (type !== "NotificationShowMessage" && type !== "NotificationUpdateMessage") return false;
  const props = mapOf(message["props"]) ?? {};
  const secs = props["auto_close_seconds"];
  notices.set(uuid, {
    uuid,
    title: String(props["title"] ?? ""),
    body: String(props["body"] ?? ""),
    loading: props["loading"] === true,
    error: props["color"] === "red",
    autoCloseSecs: typeof secs === "number" && secs > 0 ? secs : undefined,
  });
  return true;
}
