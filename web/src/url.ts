/** The page's own address: it carries the state, and no token. */
import { serverHost } from "./protocol/address";

const TOKEN = "poescope-token";
/** Browsers refuse pages that change their address too often. */
const WRITE_MS = 400;

/** A state as it stands in an address: its own marks stay readable. */
export function stateInUrl(state: string): string {
  return encodeURIComponent(state).replace(/%(3D|3B|2C|3A|40)/g, (code) => decodeURIComponent(code));
}

/** The address of a state, whatever else it says. */
export function urlOfState(page: URL, state: string): string {
  const others = new URLSearchParams(page.search);
  for (const name of ["state", "token"]) others.delete(name);
  const query = [others.toString(), state === "" ? "" : `state=${stateInUrl(state)}`].filter((part) => part !== "");
  return `${page.pathname}${query.length > 0 ? "?" : ""}${query.join("&")}`;
}

/**
 * The state that the address asks for. Read by hand: `URLSearchParams` would take a `+` for a blank, and a state may
 * have been pasted as it is.
 */
export function stateOf(search: string): string | undefined {
  const part = search
    .replace(/^\?/, "")
    .split("&")
    .find((each) => each.startsWith("state="));
  if (part === undefined) return undefined;
  const raw = part.slice("state=".length);
  try {
    return decodeURIComponent(raw);
  } catch {
    // A `%` of the state's own escapes, pasted without escaping.
    return raw;
  }
}

/** Moves the token out of the address, where it would be copied along, into the tab's own memory. */
export function keepToken(page: URL): URL {
  const url = new URL(page.href);
  const given = url.searchParams.get("token");
  // Of this server only: a link may name another one, which must not get it.
  const name = `${TOKEN}@${serverHost(page)}`;
  try {
    if (given !== null) sessionStorage.setItem(name, given);
    const kept = given ?? sessionStorage.getItem(name);
    if (kept !== null) url.searchParams.set("token", kept);
  } catch {
    // A browser that keeps nothing: it stays in this page's own copy.
  }
  return url;
}

/** Writes the state into the address now and then, the last one always. */
export class AddressBar {
  #timer: ReturnType<typeof setTimeout> | undefined;
  #state = "";

  show(state: string): void {
    if (state === this.#state || state === "") return;
    this.#state = state;
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      history.replaceState(null, "", urlOfState(new URL(location.href), this.#state));
    }, WRITE_MS);
  }
}
