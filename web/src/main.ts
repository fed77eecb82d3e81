/** Joins the parts: the connection feeds the store, the store the page. */
import "uplot/dist/uPlot.min.css";
import { App } from "./app";
import { Client } from "./client";
import { serverHost, websocketUrl } from "./protocol/address";
import { Connection } from "./protocol/connection";
import { startTheme } from "./theme";
import { keepToken, stateOf, urlOfState } from "./url";

const page = keepToken(new URL(location.href));
if (location.search.includes("token=")) {
  history.replaceState(null, "", urlOfState(new URL(location.href), stateOf(location.search) ?? ""));
}
startTheme();

/** Asked for once, by the address that the page was opened with; after that the session leads. */
let wanted = stateOf(location.search);

const client = new Client((message) => connection.send(message));
const app = new App(document.getElementById("app") as HTMLElement, client);
const connection = new Connection(
  websocketUrl(page),
  {
    opened: () => client.opened(),
    received(batch) {
      client.store.apply(batch.messages);
      if (client.store.complete && wanted !== undefined) {
        client.restore(wanted);
        wanted = undefined;
      }
      app.invalidate();
    },
    status: (status) => app.status(status),
  },
  // Only the page's own server can be asked whether it is there at all.
  () =>
    serverHost(page) === location.host
      ? fetch(".", { method: "HEAD", cache: "no-store" }).then((answer) => answer.ok)
      : Promise.resolve(false),
);
connection.connect();
