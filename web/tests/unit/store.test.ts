import { describe, expect, it } from "vitest";
import { decodeFrame, type Message } from "../../src/protocol/frame";
import { Store } from "../../src/state/store";
import { entries, bytes, frame } from "./golden";

function fed(...prefixes: string[]): Store {
  const store = new Store();
  for (const prefix of prefixes) store.apply(decodeFrame(frame(prefix)).messages);
  return store;
}

describe("controls", () => {
  it("takes what a late joiner is sent", () => {
    const store = new Store();
    const files = entries.map(({ file }) => file).filter((file) => file.startsWith("s2c_108"));
    for (const file of files) store.apply(decodeFrame(bytes(file)).messages);
    expect(store.complete).toBe(true);
    expect(store.gui.size).toBeGreaterThan(20);
    expect(store.scene.size).toBeGreaterThan(20);
    expect([...store.gui.values()].find(({ type }) => type === "GuiCheckboxMessage")?.value).toBeTypeOf("boolean");
  });

  it("updates props and value, and leaves the others", () => {
    const store = fed("s2c_003");
    const [slider] = store.gui.values();
    store.takeChanges();
    store.apply([{ type: "GuiUpdateMessage", uuid: slider?.uuid, updates: { value: 7, label: "seven" } }]);
    const changed = store.gui.get(slider?.uuid ?? "");
    expect(changed?.value).toBe(7);
    expect(changed?.props).toEqual({ ...slider?.props, label: "seven" });
    expect([...store.takeChanges().gui]).toEqual([slider?.uuid]);
    expect(store.changed).toBe(false);
  });

  it("keeps a value that was chosen here, for the server does not send it back", () => {
    const store = fed("s2c_006");
    const [box] = store.gui.values();
    store.choose(box?.uuid ?? "", true);
    expect(store.gui.get(box?.uuid ?? "")?.value).toBe(true);
    store.choose("nobody", 1);
    expect(store.gui.size).toBe(1);
  });

  it("removes, and shrugs at what it does not know", () => {
    const store = fed("s2c_006");
    const [box] = store.gui.keys();
    store.apply([
      { type: "GuiRemoveMessage", uuid: box },
      { type: "GuiUpdateMessage", uuid: "nobody", updates: { value: 1 } },
      { type: "FromTheFutureMessage", uuid: "x" },
    ]);
    expect(store.gui.size).toBe(0);
    expect([...store.skipped]).toEqual(["FromTheFutureMessage"]);
  });

  it("runs no script", () => {
    const store = new Store();
    store.apply([{ type: "RunJavascriptMessage", source: "globalThis.hit = true" } as Message]);
    expect("hit" in globalThis).toBe(false);
    expect(store.changed).toBe(false);
  });
});

describe("the scene", () => {
  it("keeps pose and visibility of a name that is sent again", () => {
    const store = fed("s2c_055");
    const [name] = [...store.scene.keys()];
    store.apply([
      { type: "SetPositionMessage", name, position: [1, 2, 3] },
      { type: "SetSceneNodeVisibilityMessage", name, visible: false },
      { type: "IcosphereMessage", name, props: { radius: 2 } },
    ]);
    expect(store.scene.get(name ?? "")).toMatchObject({
      type: "IcosphereMessage",
      position: [1, 2, 3],
      visible: false,
      props: { radius: 2 },
    });
  });

  it("removes a node with all below it, and none that merely begins alike", () => {
    const store = new Store();
    store.apply(["/a", "/a/b", "/ab"].map((name) => ({ type: "FrameMessage", name, props: {} })));
    store.apply([{ type: "RemoveSceneNodeMessage", name: "/a" }]);
    expect([...store.scene.keys()]).toEqual(["/ab"]);
  });

  it("takes no pose that is none", () => {
    const store = fed("s2c_055");
    const [name] = [...store.scene.keys()];
    store.apply([{ type: "SetPositionMessage", name, position: [1, NaN, 3] }]);
    expect(store.scene.get(name ?? "")?.position).toEqual([0, 0, 0]);
  });

  it("knows what can be clicked", () => {
    const store = fed("s2c_084");
    expect([...store.scene.values()].some(({ clickable }) => clickable)).toBe(true);
  });
});

describe("notifications", () => {
  it("come, change and go", () => {
    const store = fed("s2c_100");
    const [shown] = store.notices.values();
    expect(shown?.title).not.toBe("");
    store.apply(decodeFrame(frame("s2c_101")).messages);
    expect(store.notices.size).toBe(1);
    expect([...store.notices.values()][0]).not.toEqual(shown);
    store.apply(decodeFrame(frame("s2c_102")).messages);
    expect(store.notices.size).toBe(0);
  });
});

it("begins anew on a new connection", () => {
  const store = fed("s2c_003", "s2c_055", "s2c_100");
  store.reset();
  expect([store.gui.size, store.scene.size, store.notices.size]).toEqual([0, 0, 0]);
  expect(store.takeChanges().reset).toBe(true);
});
