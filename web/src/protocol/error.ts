/** What arrived is not what the protocol says. The text says what was expected and what was found. */
export class ProtocolError extends Error {
  override readonly name = "ProtocolError";
}
