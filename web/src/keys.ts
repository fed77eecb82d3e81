/** From a key of the keyboard to its name in the table that all faces share. */

const NAMED: Record<string, string> = {
  ArrowLeft: "left",
  ArrowRight: "right",
  ArrowUp: "up",
  ArrowDown: "down",
  Home: "home",
  End: "end",
  PageUp: "pageup",
  PageDown: "pagedown",
  Tab: "tab",
  Enter: "enter",
  Escape: "esc",
  Backspace: "backspace",
  Delete: "delete",
  " ": "space",
};

/** What of a keyboard event the name depends on. */
export interface Pressed {
  key: string;
  shiftKey: boolean;
  ctrlKey: boolean;
  altKey: boolean;
  metaKey: boolean;
  /** Composing a character. */
  isComposing: boolean;
  /** The third level of a keyboard, which types `[` and `{` in many countries. */
  altGraph: boolean;
}

/** `l`, `<space>`, `<s-left>`, `<c-k>`, `<f1>`; nothing for keys that the table has no name for. */
export function keyName(pressed: Pressed): string | undefined {
  const { key, shiftKey, isComposing } = pressed;
  if (isComposing || key === "Dead" || key === "Unidentified") return undefined;
  const character = [...key].length === 1 && key !== " ";
  if (!pressed.altGraph) {
    // The command key stands for control, so that the palette opens where one expects it. With shift they are the
    // browser's: its tools, a private window.
    if (pressed.ctrlKey || pressed.metaKey) {
      return character && !pressed.altKey && !shiftKey ? `<c-${key.toLowerCase()}>` : undefined;
    }
    if (pressed.altKey) return undefined;
  }
  if (character) return key;
  const named = NAMED[key];
  if (named !== undefined) return shiftKey && named !== "space" ? `<s-${named}>` : `<${named}>`;
  return /^F([1-9]|1[0-2])$/.test(key) ? `<${key.toLowerCase()}>` : undefined;
}

/** The names under which a typed text is sent, one a character. */
export function namesOf(text: string): string[] {
  return [...text].map((char) => (char === " " ? "<space>" : char)).filter((char) => char >= " ");
}
