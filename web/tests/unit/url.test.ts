import { describe, expect, it } from "vitest";
import { websocketUrl } from "../../src/protocol/address";
import { backoffMs } from "../../src/protocol/backoff";
import { stateOf, urlOfState } from "../../src/url";

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
