/** Where the server is: beside the page, or where the page's address says. */

/**
 * The websocket's address for a page's address. `?websocket=` names another server, as in the stock client; a
 * `?token=` goes along, since a browser's websocket can carry no header.
 */
export function websocketUrl(page: URL): string {
  const named = namedServer(page);
  const url = new URL(named ?? page);
  if (named === undefined) {
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

/** Host and port of that server. */
export function serverHost(page: URL): string {
  return (namedServer(page) ?? page).host;
}

/** What `?websocket=` names; what is no websocket's address names nothing. */
function namedServer(page: URL): URL | undefined {
  try {
    const url = new URL(page.searchParams.get("websocket") ?? "");
    return /^wss?:$/.test(url.protocol) ? url : undefined;
  } catch {
    return undefined;
  }
}
