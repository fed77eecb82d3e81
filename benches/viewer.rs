//! A viewer over viser's protocol, as far as benches need one.

use poescope::web::protocol::SUBPROTOCOL;
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::{WebSocketStream, client_async};

/// Comes to the server at a port of this machine.
pub async fn connect(port: u16) -> WebSocketStream<TcpStream> {
    let mut request = format!("ws://127.0.0.1:{port}/")
        .into_client_request()
        .unwrap();
    request
        .headers_mut()
        .insert("sec-websocket-protocol", SUBPROTOCOL.parse().unwrap());
    let stream = TcpStream::connect(("127.0.0.1", port)).await.unwrap();
    client_async(request, stream).await.unwrap().0
}

/// The step that a frame says, if it says one.
pub fn step_in(frame: &[u8]) -> Option<f64> {
    let length =
        |at: usize| Some(u64::from_le_bytes(frame.get(at..at + 8)?.try_into().ok()?) as usize);
    let packed = zstd::bulk::decompress(frame.get(16..16 + length(8)?)?, length(0)?).ok()?;
    let name = b"poescope-step";
    let at = packed
        .windows(name.len())
        .position(|window| window == name)?;
    let after = &packed[at + name.len()..];
    let value = after.windows(6).position(|window| window == b"value\xcb")?;
    Some(f64::from_be_bytes(
        after.get(value + 6..value + 14)?.try_into().ok()?,
    ))
}
