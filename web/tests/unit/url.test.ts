import { afterEach, describe, expect, it, vi } from "vitest";
import { websocketUrl } from "../../src/protocol/address";
import { backoffMs } from "../../src/protocol/backoff";
import { keepToken, stateOf, urlOfState } from "../../src/url";

const page = (text: string) => new URL(text);

describe("the server's address", () => {
  it("is the page's own", () => {
    expect(websocketUrl(page("http://127.0.0.1:8080/?state=v=1#x"))).toBe("ws://127.0.0.1:8080/");
    expect(websocketUrl(page("https://lab.example/a/index.html"))).toBe("wss://lab.example/a/");
  });

  it("takes the token along", () => {
    expect(websocketUrl(page("http://10.0.0.2:8080/?token=a%26b"))).toBe("ws://10.0.0.2:8080/?token=a%26b");
  });

  it("may be another one", () => {
    expect(websocketUrl(page("http://127.0.0.1:5173/?websocket=ws://127.0.0.1:9000"))).toBe("ws://127.0.0.1:9000/");
  });

  it("is the page's own where the other one is no websocket's", () => {
    for (const other of ["foo", "", "javascript:1", "//h"])
      expect(websocketUrl(page(`http://127.0.0.1:8080/?websocket=${other}`))).toBe("ws://127.0.0.1:8080/");
  });
});

describe("the token", () => {
  afterEach(() => vi.unstubAllGlobals());

  it("is kept for the server that it was given for, and for no other", () => {
    const kept = new Map<string, string>();
    vi.stubGlobal("sessionStorage", {
      getItem: (name: string) => kept.get(name) ?? null,
      setItem: (name: string, value: string) => kept.set(name, value),
    });
    const asked = (text: string) => websocketUrl(keepToken(page(text)));
    expect(asked("http://h:1/?token=a")).toBe("ws://h:1/?token=a");
    expect(asked("http://h:1/")).toBe("ws://h:1/?token=a");
    expect(asked("http://h:1/?websocket=ws://h:1/x")).toBe("ws://h:1/x?token=a");
    expect(asked("http://h:1/?websocket=foo")).toBe("ws://h:1/?token=a");
    for (const other of ["wss://evil/", "ws://h:2/", "ws://h:1@evil/"])
      expect(asked(`http://h:1/?websocket=${other}`)).not.toContain("token");
    expect(asked("http://h:1/?websocket=ws://h:2/&token=b")).toBe("ws://h:2/?token=b");
    expect(asked("http://h:1/?websocket=ws://h:2/")).toBe("ws://h:2/?token=b");
    expect(asked("http://h:1/")).toBe("ws://h:1/?token=a");
  });
});

describe("the state in the page's address", () => {
  const state = "v=1;episode=a b&c%3B;step=9;alpha=vision:0@1-15,haptic:0.5@4;x=50%+1";

  it("comes back as it was", () => {
    const url = urlOfState(page("http://h/?websocket=ws://x&token=t&state=old"), state);
    expect(stateOf(page(`http://h${url}`).search)).toBe(state);
    expect(url).toContain("websocket=");
    expect(url).not.toContain("token");
  });

  it("stays readable", () => {
    expect(urlOfState(page("http://h/"), "v=1;alpha=vision:0@1-15,haptic:0.5@4")).toBe(
      "/?state=v=1;alpha=vision:0@1-15,haptic:0.5@4",
    );
    expect(urlOfState(page("http://h/"), "")).toBe("/");
  });

  it("may have been pasted as it is, or not be there", () => {
    expect(stateOf("?state=v=1;x=50%")).toBe("v=1;x=50%");
    expect(stateOf("?token=1")).toBeUndefined();
  });
});

describe("waiting for a server", () => {
  it("doubles, has an end, and differs between viewers", () => {
    expect([1, 2, 3].map((n) => backoffMs(n, 0.5))).toEqual([250, 500, 1000]);
    expect(backoffMs(50, 1)).toBe(10000);
    expect(backoffMs(1, 0)).toBeLessThan(backoffMs(1, 1));
  });
});
