//! Answers to requests: a file of the table, or the way to the websocket.

use std::sync::Arc;

use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use hyper::upgrade::OnUpgrade;
use hyper::{Method, Request, Response, StatusCode};
use tokio::sync::OwnedSemaphorePermit;
use tokio_tungstenite::tungstenite::handshake::derive_accept_key;

use super::connection::{self, Version};
use super::guard::{Guard, Refusal};
use crate::web::assets::Assets;
use crate::web::hub::Hub;
use crate::web::protocol::{ALSO, PREFIX, SUBPROTOCOL};

/// Viewers at once.
const VIEWERS: usize = 256;
/// What the page may do: run its own code, talk to this server, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; \
    style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; \
    connect-src 'self' ws: wss:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// What is served.
pub struct Site {
    /// Files.
    pub assets: Assets,
    /// Who may.
    pub guard: Guard,
    /// The session.
    pub hub: Arc<Hub>,
}

type Answer = Response<Full<Bytes>>;

/// Answers one request; `place` is held as long as the connection lives.
pub fn answer(
    site: &Arc<Site>,
    place: Arc<OwnedSemaphorePermit>,
    request: Request<Incoming>,
) -> Answer {
    if let Err(refusal) = site.guard.host(request.headers()) {
        return refused(refusal);
    }
    if asks_for_socket(request.headers()) {
        return socket(site, place, request);
    }
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return plain(StatusCode::METHOD_NOT_ALLOWED, "only GET and HEAD");
    }
    let path = request.uri().path();
    let Some(asset) = site.assets.get(path) else {
        return plain(StatusCode::NOT_FOUND, "no such page");
    };
    // Files with a hash in their names never change.
    let kept = path.starts_with("/assets/");
    let cache = if kept {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    };
    let bytes = if request.method() == Method::HEAD {
        Bytes::new()
    } else {
        asset.bytes.clone()
    };
    let mut answer = with(StatusCode::OK, bytes, &asset.mime);
    let headers = answer.headers_mut();
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static(cache));
    headers.insert(header::CONTENT_LENGTH, HeaderValue::from(asset.bytes.len()));
    answer
}

fn asks_for_socket(headers: &HeaderMap) -> bool {
    let upgrade = headers
        .get(header::UPGRADE)
        .and_then(|value| value.to_str().ok());
    upgrade.is_some_and(|value| value.eq_ignore_ascii_case("websocket"))
}

fn socket(
    site: &Arc<Site>,
    place: Arc<OwnedSemaphorePermit>,
    mut request: Request<Incoming>,
) -> Answer {
    if let Err(refusal) = site.guard.socket(request.headers(), request.uri().query()) {
        return refused(refusal);
    }
    let headers = request.headers();
    let key = headers.get(header::SEC_WEBSOCKET_KEY);
    let is_13 = headers
        .get(header::SEC_WEBSOCKET_VERSION)
        .is_some_and(|version| version == "13");
    let Some(key) = key.filter(|_| is_13 && request.method() == Method::GET) else {
        return plain(StatusCode::BAD_REQUEST, "not a websocket of version 13");
    };
    let accept = derive_accept_key(key.as_bytes());
    let offered = headers.get_all(header::SEC_WEBSOCKET_PROTOCOL).iter();
    let offered: Vec<&str> = offered
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .map(str::trim)
        .collect();
    let known = offered
        .iter()
        .find(|name| [SUBPROTOCOL, ALSO].contains(name));
    let chosen = known.or_else(|| offered.iter().find(|name| name.starts_with(PREFIX)));
    let version = match (known, chosen) {
        (Some(_), _) => Version::Known,
        (None, chosen) => {
            let theirs = chosen.and_then(|name| name.strip_prefix(PREFIX));
            Version::Other(theirs.unwrap_or("unknown").chars().take(20).collect())
        }
    };
    let chosen = chosen.and_then(|name| HeaderValue::from_str(name).ok());
    let viewer = match version {
        Version::Known => match site.hub.join(VIEWERS) {
            Some(viewer) => Some(viewer),
            None => return plain(StatusCode::SERVICE_UNAVAILABLE, "too many viewers"),
        },
        Version::Other(_) => None,
    };
    let upgrade: OnUpgrade = hyper::upgrade::on(&mut request);
    let hub = Arc::clone(&site.hub);
    tokio::spawn(async move {
        connection::run(upgrade, &hub, viewer, version).await;
        drop(place);
    });

    let mut answer = with(StatusCode::SWITCHING_PROTOCOLS, Bytes::new(), "");
    let headers = answer.headers_mut();
    headers.remove(header::CONTENT_TYPE);
    headers.insert(header::CONNECTION, HeaderValue::from_static("upgrade"));
    headers.insert(header::UPGRADE, HeaderValue::from_static("websocket"));
    if let Ok(accept) = HeaderValue::from_str(&accept) {
        headers.insert(header::SEC_WEBSOCKET_ACCEPT, accept);
    }
    if let Some(chosen) = chosen {
        headers.insert(header::SEC_WEBSOCKET_PROTOCOL, chosen);
    }
    answer
}

fn refused(refusal: Refusal) -> Answer {
    match refusal {
        Refusal::Host => plain(StatusCode::FORBIDDEN, "this server has another name"),
        Refusal::Origin => plain(
            StatusCode::FORBIDDEN,
            "a page of another site may not do this",
        ),
        Refusal::Token => plain(
            StatusCode::UNAUTHORIZED,
            "the token is missing or wrong; the address that poescope printed has it",
        ),
    }
}

fn plain(status: StatusCode, text: &'static str) -> Answer {
    with(
        status,
        Bytes::from_static(text.as_bytes()),
        "text/plain; charset=utf-8",
    )
}

fn with(status: StatusCode, bytes: Bytes, mime: &str) -> Answer {
    let mut answer = Response::new(Full::new(bytes));
    *answer.status_mut() = status;
    let headers = answer.headers_mut();
    if let Ok(mime) = HeaderValue::from_str(mime) {
        headers.insert(header::CONTENT_TYPE, mime);
    }
    let fixed: [(HeaderName, &'static str); 5] = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    answer
}
