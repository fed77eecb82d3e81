//! The program itself: what it prints, and that it ends when it is told to.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::poescope;

/// Starts it on a free port; what it printed first.
fn serve(options: &[&str]) -> (Child, Vec<String>) {
    let mut command = poescope();
    command.args(["serve", "--port", "0"]).args(options);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    (child, lines.take(2).map(Result::unwrap).collect())
}

/// Ends it as Ctrl-C does; whether it ended well and soon.
fn interrupt(mut child: Child) -> bool {
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let deadline = Instant::now() + Duration::from_secs(20);
    while Instant::now() < deadline {
        if let Some(status) = child.try_wait().unwrap() {
            return status.success();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    false
}

#[test]
fn it_says_where_it_is_serves_there_and_ends_when_told() {
    let (child, lines) = serve(&[]);
    let place = lines[0]
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .to_owned();
    assert!(place.starts_with("127.0.0.1:"), "{lines:?}");
    let port = place.rsplit(':').next().unwrap();
    assert!(
        lines[1].contains(&format!("ssh -L {port}:127.0.0.1:{port}")),
        "{lines:?}"
    );
    let mut stream = TcpStream::connect(&place).unwrap();
    stream
        .write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        .unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    assert!(page.starts_with("HTTP/1.1 200 "), "{page}");

    let taken = poescope().args(["serve", "--port", port]).output().unwrap();
    let said = String::from_utf8_lossy(&taken.stderr).into_owned();
    assert!(!taken.status.success() && said.contains("--port"), "{said}");
    assert!(interrupt(child));
}

#[test]
fn beyond_this_machine_it_prints_a_token() {
    let (child, lines) = serve(&["--host", "0.0.0.0"]);
    let token = lines[0]
        .split("/?token=")
        .nth(1)
        .unwrap_or_default()
        .to_owned();
    assert_eq!(token.len(), 32, "{lines:?}");
    assert!(lines[1].contains(&token), "{lines:?}");
    assert!(interrupt(child));
}
