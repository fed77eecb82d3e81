/** Where the server is: beside the page, or where the page's address says. */

/**
 * The websocket's address for a page's address. `?websocket=` names another server, as in the stock client; a
 * `?token=` goes along, since a browser's websocket can carry no header.
 */
export function websocketUrl(page: URL): string {
  const named = page.searchParams.get("websocket");
  const url = new URL(named ?? page.href);
  if (named === null) {
    url.protocol = page.protocol === "https:" ? "wss:" : "ws:";
    url.search = "";
    url.pathname = url.pathname.replace(/[^/]*$/, "");
  }
  url.hash = "";
  const token = page.searchParams.get("token");
  if (token !== null && !url.searchParams.has("token")) {
    url.searchParams.set("token", token);
  }
  return url.href;
}
