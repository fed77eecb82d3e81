//! A server at a made-up session, and a client that knows what it has been told.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use poescope::session::Session;
use poescope::session::fake::{FakePredictor, FakeSource};
use poescope::web::assets::Assets;
use poescope::web::protocol::frame;
use poescope::web::server::{Options, Server};
use serde_json::Value;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::handshake::client::Response;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{WebSocketStream, client_async};

/// The longest that anything may take; it takes some milliseconds.
const PATIENCE: Duration = Duration::from_secs(20);

/// Runs a client.
pub(crate) fn run(client: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.unwrap().block_on(client);
}

/// A session on a thread of its own, and its server.
pub(crate) struct Running {
    pub(crate) address: SocketAddr,
    pub(crate) token: Option<String>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    pub(crate) fn start(read_only: bool) -> Self {
        Self::at([127, 0, 0, 1].into(), read_only)
    }

    pub(crate) fn at(ip: IpAddr, read_only: bool) -> Self {
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        let (sender, receiver) = channel();
        let thread = std::thread::spawn(move || {
            let source = Arc::new(FakeSource::new(3));
            let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
            assert!(session.wait_idle(PATIENCE));
            let address = SocketAddr::new(ip, 0);
            let options = Options {
                address,
                read_only,
                assets: Assets::built_in(),
            };
            let server = Server::start(&mut session, options).unwrap();
            sender
                .send((server.address(), server.token().map(str::to_owned)))
                .unwrap();
            while !end.load(Ordering::Relaxed) {
                session.update(Duration::from_millis(2));
                std::thread::sleep(Duration::from_millis(2));
            }
        });
        let (address, token) = receiver.recv().unwrap();
        Self {
            address,
            token,
            ended,
            thread: Some(thread),
        }
    }

    pub(crate) fn stop(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop();
        self.thread.take().unwrap().join().unwrap();
    }
}

/// One viewer: its socket and what it has been told.
pub(crate) struct View {
    socket: WebSocketStream<TcpStream>,
    elements: BTreeMap<String, Value>,
    messages: Vec<Value>,
}

impl View {
    /// Connects, with more headers than usual.
    pub(crate) async fn try_connect(
        port: u16,
        path: &str,
        headers: &[(&'static str, &str)],
    ) -> Result<(Self, Response), Error> {
        let url = format!("ws://127.0.0.1:{port}{path}");
        let mut request = url.into_client_request().unwrap();
        let known = ("sec-websocket-protocol", "viser-v1.1.1");
        for (name, value) in [known].iter().chain(headers) {
            if value.is_empty() {
                request.headers_mut().remove(*name);
            } else {
                request.headers_mut().insert(*name, value.parse().unwrap());
            }
        }
        let stream = TcpStream::connect(("127.0.0.1", port)).await.unwrap();
        let (socket, answer) = client_async(request, stream).await?;
        let view = Self {
            socket,
            elements: BTreeMap::new(),
            messages: Vec::new(),
        };
        Ok((view, answer))
    }

    pub(crate) async fn connect(
        server: &Running,
        headers: &[(&'static str, &str)],
    ) -> (Self, Response) {
        let port = server.address.port();
        Self::try_connect(port, "/", headers).await.unwrap()
    }

    /// Connects and takes in all there is.
    pub(crate) async fn come(server: &Running) -> Self {
        Self::come_to(server.address.port()).await
    }

    /// The same, to a server of its own program.
    pub(crate) async fn come_to(port: u16) -> Self {
        let (mut view, _) = Self::try_connect(port, "/", &[]).await.unwrap();
        view.replay().await;
        view
    }

    pub(crate) async fn replay(&mut self) {
        let done = |view: &Self| {
            view.messages
                .iter()
                .any(|message| message["type"] == "ReplayDoneMessage")
        };
        self.until("the whole state", done).await;
        self.messages.clear();
    }

    /// Takes in what comes until something holds.
    pub(crate) async fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !holds(self) {
            let left = deadline.saturating_duration_since(Instant::now());
            match timeout(left, self.socket.next()).await {
                Ok(Some(Ok(Message::Binary(bytes)))) => self.take(&bytes),
                Ok(Some(Ok(Message::Ping(_)))) => {}
                other => panic!("{other:?} while waiting for {what}"),
            }
        }
    }

    /// Takes in what comes for so long.
    pub(crate) async fn wait(&mut self, time: Duration) {
        let deadline = Instant::now() + time;
        while let Ok(Some(Ok(message))) = timeout(
            deadline.saturating_duration_since(Instant::now()),
            self.socket.next(),
        )
        .await
        {
            if let Message::Binary(bytes) = message {
                self.take(&bytes);
            }
        }
    }

    /// How the connection ends.
    pub(crate) async fn end(&mut self) -> Option<(u16, String)> {
        let last = async {
            loop {
                match self.socket.next().await? {
                    Ok(Message::Close(close)) => {
                        return close.map(|close| (close.code.into(), close.reason.to_string()));
                    }
                    Ok(_) => {}
                    Err(_) => return None,
                }
            }
        };
        timeout(PATIENCE, last).await.unwrap()
    }

    fn take(&mut self, bytes: &[u8]) {
        for message in frame::read(bytes).unwrap().messages {
            if let Some(uuid) = message["uuid"].as_str() {
                if message["type"] == "GuiUpdateMessage" {
                    let element = self
                        .elements
                        .get_mut(uuid)
                        .expect("an update of what there is");
                    for (name, value) in message["updates"].as_object().unwrap() {
                        let place = if name == "value" {
                            &mut element["value"]
                        } else {
                            &mut element["props"][name]
                        };
                        *place = value.clone();
                    }
                } else {
                    self.elements.insert(uuid.to_owned(), message.clone());
                }
            }
            self.messages.push(message);
        }
    }

    pub(crate) fn value(&self, uuid: &str) -> Value {
        self.elements[uuid]["value"].clone()
    }

    pub(crate) fn prop(&self, uuid: &str, name: &str) -> Value {
        self.elements[uuid]["props"][name].clone()
    }

    pub(crate) fn meta(&self) -> Value {
        serde_json::from_str(self.value("poescope-meta").as_str().unwrap()).unwrap()
    }

    pub(crate) fn face(&self) -> Value {
        serde_json::from_str(self.value("poescope-face").as_str().unwrap()).unwrap()
    }

    /// How often the value of an element was told since all of it was.
    pub(crate) fn updates_of(&self, uuid: &str) -> usize {
        let updates = self
            .messages
            .iter()
            .filter(|message| message["uuid"] == uuid);
        updates
            .filter(|message| message["updates"].get("value").is_some())
            .count()
    }

    pub(crate) fn notes(&self) -> usize {
        self.messages
            .iter()
            .filter(|message| message["type"] == "NotificationShowMessage")
            .count()
    }

    pub(crate) fn scene_moved(&self, name: &str) -> bool {
        let poses = self
            .messages
            .iter()
            .filter(|message| message["type"] == "SetPositionMessage");
        poses.filter(|message| message["name"] == name).count() > 0
    }

    pub(crate) async fn send(&mut self, message: &Value) {
        let bytes = rmp_serde::to_vec_named(message).unwrap();
        self.raw(Message::Binary(bytes.into())).await;
    }

    pub(crate) async fn raw(&mut self, message: Message) {
        // A server that has had enough may be gone already; the tests ask how it went.
        let _ = self.socket.send(message).await;
    }

    pub(crate) async fn set(&mut self, uuid: &str, value: &Value) {
        let updates = serde_json::json!({ "value": value });
        let message =
            serde_json::json!({ "type": "GuiUpdateMessage", "uuid": uuid, "updates": updates });
        self.send(&message).await;
    }
}
