//! Who gets in, and what there is without a websocket.

use std::io::{Read, Write};
use std::net::TcpStream;

use tokio_tungstenite::tungstenite::Error;

use super::client::{Running, View, run};

/// The status of an attempt to connect; 101 for one that worked.
async fn attempt(server: &Running, path: &str, headers: &[(&'static str, &str)]) -> u16 {
    match View::try_connect(server.address.port(), path, headers).await {
        Ok((_, answer)) => answer.status().as_u16(),
        Err(Error::Http(answer)) => answer.status().as_u16(),
        Err(error) => panic!("{error}"),
    }
}

/// The answer to a request as it is written, head and body.
fn ask(server: &Running, request: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", server.address.port())).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

fn get(server: &Running, path: &str) -> String {
    ask(
        server,
        &format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
    )
}

#[test]
fn pages_of_other_sites_and_names_made_to_point_here_stay_outside() {
    let server = Running::start(false);
    run(async {
        let near = "http://127.0.0.1:5173";
        assert_eq!(attempt(&server, "/", &[("origin", near)]).await, 101);
        assert_eq!(
            attempt(&server, "/", &[("origin", "https://example.org")]).await,
            403
        );
        assert_eq!(attempt(&server, "/", &[("origin", "null")]).await, 403);
        let rebound = [
            ("host", "example.org:8080"),
            ("origin", "http://example.org:8080"),
        ];
        assert_eq!(attempt(&server, "/", &rebound).await, 403);
    });
    let rebound = ask(
        &server,
        "GET / HTTP/1.1\r\nHost: example.org\r\nConnection: close\r\n\r\n",
    );
    assert!(rebound.starts_with("HTTP/1.1 403 "), "{rebound}");
}

#[test]
fn beyond_loopback_only_the_token_opens() {
    let server = Running::at([0, 0, 0, 0].into(), false);
    let token = server.token.clone().unwrap();
    run(async {
        assert_eq!(attempt(&server, "/", &[]).await, 401);
        assert_eq!(attempt(&server, "/?token=0", &[]).await, 401);
        assert_eq!(
            attempt(&server, &format!("/?token={token}"), &[]).await,
            101
        );
        assert_eq!(
            attempt(&server, "/", &[("x-poescope-token", &token)]).await,
            101
        );
        let foreign = ("origin", "https://example.org");
        assert_eq!(
            attempt(&server, &format!("/?token={token}"), &[foreign]).await,
            403
        );
    });
    assert!(
        get(&server, "/").starts_with("HTTP/1.1 200 "),
        "the page itself is no secret"
    );
}

#[test]
fn there_is_a_page_with_a_strict_policy_and_no_way_to_the_files() {
    let server = Running::start(false);
    let page = get(&server, "/");
    assert!(
        page.starts_with("HTTP/1.1 200 ") && page.contains("poescope"),
        "{page}"
    );
    let head = page.split("\r\n\r\n").next().unwrap().to_lowercase();
    for policy in [
        "default-src 'none'",
        "frame-ancestors 'none'",
        "script-src 'self' 'wasm-unsafe-eval';",
        "nosniff",
    ] {
        assert!(head.contains(policy), "{policy}: {head}");
    }
    for path in [
        "/../Cargo.toml",
        "/%2e%2e/Cargo.toml",
        "/etc/passwd",
        "//etc/passwd",
        "/assets/../../Cargo.toml",
        "/assets",
    ] {
        assert!(get(&server, path).starts_with("HTTP/1.1 404 "), "{path}");
    }
    let post = ask(
        &server,
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\nConnection: close\r\n\r\n",
    );
    assert!(post.starts_with("HTTP/1.1 405 "), "{post}");
}

#[test]
fn another_version_is_told_which_there_is() {
    let server = Running::start(false);
    run(async {
        let other = [("sec-websocket-protocol", "viser-v0.2.7")];
        let (mut view, answer) = View::connect(&server, &other).await;
        assert_eq!(answer.headers()["sec-websocket-protocol"], "viser-v0.2.7");
        let reason = "Version mismatch. Client: 0.2.7, Server: 1.1.1".to_owned();
        assert_eq!(view.end().await, Some((1002, reason)));
        let none = [("sec-websocket-protocol", "")];
        let (mut view, _) = View::connect(&server, &none).await;
        let reason = "Version mismatch. Client: unknown, Server: 1.1.1".to_owned();
        assert_eq!(view.end().await, Some((1002, reason)));
        assert_eq!(
            attempt(&server, "/", &[("sec-websocket-protocol", "viser-v1.1.0")]).await,
            101
        );
    });
}
