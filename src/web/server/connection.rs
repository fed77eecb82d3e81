//! One websocket: what waits for its viewer goes out, what the viewer says is heard, and neither waits for the other.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use hyper::body::Bytes;
use hyper::upgrade::{OnUpgrade, Upgraded};
use hyper_util::rt::TokioIo;
use tokio::time::{interval, sleep, timeout};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tokio_tungstenite::tungstenite::{Error, Message};

use super::limits::Allowance;
use crate::web::hub::Hub;
use crate::web::protocol::{SUBPROTOCOL, inbound};
use crate::web::viewer::Viewer;

/// A longer message is nobody's: a client says little.
const LARGEST: usize = 64 << 10;
/// One frame that takes longer to send than this goes to a viewer that has stalled.
const STALLED: Duration = Duration::from_secs(15);
/// Between two questions whether anybody is there.
const HEARTBEAT: Duration = Duration::from_secs(20);
/// The longest that a farewell may take.
const FAREWELL: Duration = Duration::from_secs(1);

type Socket = WebSocketStream<TokioIo<Upgraded>>;

/// What a client speaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Version {
    /// What is spoken here.
    Known,
    /// Something else.
    Other(String),
}

/// Runs a connection to its end.
pub async fn run(
    upgrade: OnUpgrade,
    hub: &Arc<Hub>,
    viewer: Option<Arc<Viewer>>,
    version: Version,
) {
    if let Ok(upgraded) = upgrade.await {
        let config = WebSocketConfig::default()
            .max_message_size(Some(LARGEST))
            .max_frame_size(Some(LARGEST));
        let io = TokioIo::new(upgraded);
        let socket = WebSocketStream::from_raw_socket(io, Role::Server, Some(config)).await;
        match (&viewer, version) {
            (Some(viewer), _) => serve(socket, hub, viewer).await,
            (None, Version::Known) => {}
            (None, Version::Other(theirs)) => turn_away(socket, &theirs).await,
        }
    }
    if let Some(viewer) = viewer {
        hub.leave(&viewer);
    }
}

/// Says which version there is. Not at once: such a client comes back as soon as it is told.
async fn turn_away(mut socket: Socket, theirs: &str) {
    sleep(FAREWELL).await;
    let ours = SUBPROTOCOL.trim_start_matches("viser-v");
    let reason = format!("Version mismatch. Client: {theirs}, Server: {ours}");
    let close = CloseFrame {
        code: 1002.into(),
        reason: reason.into(),
    };
    let _ = timeout(FAREWELL, socket.close(Some(close))).await;
}

async fn serve(socket: Socket, hub: &Hub, viewer: &Viewer) {
    let (mut sink, mut stream) = socket.split();
    let heard = AtomicU64::new(0);
    let writing = write(&mut sink, hub, viewer, &heard);
    tokio::pin!(writing);
    tokio::select! {
        () = &mut writing => {}
        () = read(&mut stream, hub, viewer, &heard) => {
            // Where there is a farewell to say, it is still said, and heard: the rest of what comes is thrown away, or
            // the system would break the connection off before the other side has read it.
            if viewer.farewell().is_some() {
                let _ = timeout(FAREWELL, writing).await;
                let rest = async { while stream.next().await.is_some_and(|message| message.is_ok()) {} };
                let _ = timeout(FAREWELL, rest).await;
            }
        }
    }
}

/// Sends what waits, until there is a farewell to say or nobody takes it any more.
async fn write(
    sink: &mut SplitSink<Socket, Message>,
    hub: &Hub,
    viewer: &Viewer,
    heard: &AtomicU64,
) {
    let mut heartbeat = interval(HEARTBEAT);
    heartbeat.reset();
    let mut heard_then = None;
    loop {
        let message = tokio::select! {
            () = viewer.wake.notified() => None,
            _ = heartbeat.tick() => Some(Message::Ping(Bytes::new())),
        };
        if let Some(farewell) = viewer.farewell() {
            let close = CloseFrame {
                code: farewell.code.into(),
                reason: farewell.reason.into(),
            };
            let _ = timeout(FAREWELL, sink.send(Message::Close(Some(close)))).await;
            return;
        }
        if message.is_some() {
            let heard_now = heard.load(Ordering::Relaxed);
            if heard_then == Some(heard_now) {
                viewer.close(1001, "no answer to a ping");
                viewer.wake.notify_one();
                continue;
            }
            heard_then = Some(heard_now);
        }
        let waiting = viewer.take(hub.secs()).into_iter().map(Message::Binary);
        for message in message.into_iter().chain(waiting) {
            match timeout(STALLED, sink.send(message)).await {
                Ok(Ok(())) => {}
                // It has gone, or takes nothing any more: there is no way to tell it.
                Ok(Err(_)) | Err(_) => return,
            }
        }
    }
}

/// Hears what a viewer says, until it goes or says what nobody should.
async fn read(stream: &mut SplitStream<Socket>, hub: &Hub, viewer: &Viewer, heard: &AtomicU64) {
    let mut allowance = Allowance::new(Instant::now());
    while let Some(message) = stream.next().await {
        heard.fetch_add(1, Ordering::Relaxed);
        if viewer.farewell().is_some() {
            return;
        }
        let message = match message {
            Ok(message) => message,
            Err(Error::Capacity(_)) => {
                viewer.close(1009, &format!("a message has at most {LARGEST} bytes"));
                return;
            }
            Err(Error::Protocol(error)) => {
                viewer.close(1002, &error.to_string());
                return;
            }
            Err(_) => return,
        };
        if matches!(message, Message::Close(_)) {
            return;
        }
        if !allowance.take(Instant::now()) {
            viewer.close(1008, "too many messages");
            return;
        }
        match message {
            Message::Binary(bytes) => match inbound::read(&bytes) {
                Ok(message) => hub.hear(viewer, &message),
                Err(malformed) => {
                    viewer.close(1008, &malformed.to_string());
                    return;
                }
            },
            Message::Text(_) => {
                viewer.close(1003, "text: a viser client sends binary messages");
                return;
            }
            _ => {}
        }
    }
}
