//! One port for the page and the websocket, on a thread of its own.

mod connection;
mod guard;
mod http;
mod limits;
mod token;

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::sync::{Notify, Semaphore, oneshot};
use tokio::time::{sleep, timeout};

use super::assets::Assets;
use super::hub::Hub;
use crate::session::Session;
use guard::Guard;
use http::Site;

/// Connections of any kind.
const CONNECTIONS: usize = 512;
/// The longest that a client may take to say what it wants.
const PATIENCE: Duration = Duration::from_secs(10);
/// The longest head of a request.
const HEAD: usize = 16 << 10;
/// The longest that farewells may take.
const FAREWELL: Duration = Duration::from_millis(400);

/// How to serve.
#[derive(Debug)]
pub struct Options {
    /// Where to listen. Beyond loopback a token is demanded.
    pub address: SocketAddr,
    /// Whether viewers may only look.
    pub read_only: bool,
    /// What a browser is given.
    pub assets: Assets,
}

/// A running server. Dropped, it says farewell and ends.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: Option<String>,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Attaches browsers to a session.
    ///
    /// # Errors
    /// Where the address is not to be had, or there can be no thread.
    pub fn start(session: &mut Session, options: Options) -> io::Result<Self> {
        let listener = TcpListener::bind(options.address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let token = (!is_loopback(address.ip())).then(token::new);
        let news = Arc::new(Notify::new());
        let ring = Arc::clone(&news);
        let attached = session.attach(Box::new(move || ring.notify_one()));
        let read_only = options.read_only;
        let assets = options.assets;
        let guard = Guard::new(address.ip(), token.clone());
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let (stop, stopped) = oneshot::channel();
        let thread = std::thread::Builder::new()
            .name("poescope-web".to_owned())
            .spawn(move || {
                runtime.block_on(async {
                    let hub = Arc::new(Hub::new(attached, news, read_only));
                    let site = Arc::new(Site {
                        assets,
                        guard,
                        hub: Arc::clone(&hub),
                    });
                    tokio::select! {
                        () = hub.run() => {}
                        () = listen(listener, site) => {}
                        _ = stopped => {}
                    }
                    hub.close_all(1001, "poescope has ended");
                    sleep(FAREWELL).await;
                });
                runtime.shutdown_background();
            })?;
        Ok(Self {
            address,
            token,
            stop: Some(stop),
            thread: Some(thread),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What a client has to bring, where it has to.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// Where it is found on this machine; where it listens everywhere, its loopback.
    pub fn near(&self) -> SocketAddr {
        let ip = match self.address.ip() {
            IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
            IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
            ip => ip,
        };
        SocketAddr::new(ip, self.address.port())
    }

    /// What to open in a browser on this machine.
    pub fn url(&self) -> String {
        let place = self.near();
        match &self.token {
            Some(token) => format!("http://{place}/?token={token}"),
            None => format!("http://{place}/"),
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(stop) = self.stop.take() {
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            // It catches what goes wrong in a connection; there is nothing else to tell.
            let _ = thread.join();
        }
    }
}

fn is_loopback(ip: IpAddr) -> bool {
    ip.to_canonical().is_loopback()
}

async fn listen(listener: TcpListener, site: Arc<Site>) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No more file descriptors, most likely; some come back.
            sleep(Duration::from_millis(100)).await;
            continue;
        };
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            continue;
        };
        // Small messages are sent at once; where that cannot be, they are only later.
        let _ = stream.set_nodelay(true);
        let place = Arc::new(place);
        let site = Arc::clone(&site);
        tokio::spawn(async move {
            let service = service_fn(|request| {
                let (site, place) = (Arc::clone(&site), Arc::clone(&place));
                async move { Ok::<_, std::convert::Infallible>(http::answer(&site, place, request)) }
            });
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .max_buf_size(HEAD)
                .serve_connection(TokioIo::new(stream), service)
                .with_upgrades();
            // A connection that breaks off concerns nobody else; one that only holds its place is let go.
            let _ = timeout(30 * PATIENCE, connection).await;
        });
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use super::*;

    #[test]
    fn one_that_listens_everywhere_is_opened_by_its_loopback() {
        for (address, url) in [
            ("0.0.0.0:80", "http://127.0.0.1:80/"),
            ("[::]:80", "http://[::1]:80/"),
            ("192.0.2.7:80", "http://192.0.2.7:80/"),
        ] {
            let server = Server {
                address: address.parse().unwrap(),
                token: None,
                stop: None,
                thread: None,
            };
            assert_eq!(server.url(), url);
        }
    }
}
