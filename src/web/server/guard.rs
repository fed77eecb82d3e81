//! Who may speak to the server: by the name it was called by, by the page that called, and by the token.
//!
//! Any page that a user visits can call a server on loopback. Such a call names its page in `Origin`, which no page can
//! forge. And a page can have its own name point to loopback (rebinding): then `Host` names a host that is not ours.

use std::net::IpAddr;

use hyper::header::{AUTHORIZATION, HOST, HeaderMap, HeaderName, ORIGIN};

use super::token::same;

/// Our own header with the token.
const TOKEN: HeaderName = HeaderName::from_static("x-poescope-token");

/// What callers are held against.
#[derive(Debug)]
pub struct Guard {
    loopback: bool,
    /// This machine's name, where callers may use it.
    host: Option<String>,
    token: Option<String>,
}

/// Why a caller is turned away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It calls a host that this is not.
    Host,
    /// It is a page of somebody else's.
    Origin,
    /// It has not brought the token.
    Token,
}

impl Guard {
    /// Of a server at this address.
    pub fn new(ip: IpAddr, token: Option<String>) -> Self {
        let host = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
        let host = host.or_else(|| std::env::var("HOSTNAME").ok());
        let host = host
            .map(|name| name.trim().to_lowercase())
            .filter(|name| !name.is_empty());
        Self {
            loopback: super::is_loopback(ip),
            host,
            token,
        }
    }

    /// Turns away who calls a foreign host.
    pub fn host(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = only(headers, &HOST).ok_or(Refusal::Host)?;
        let name = name_of(host).ok_or(Refusal::Host)?;
        if self.is_ours(&name) {
            Ok(())
        } else {
            Err(Refusal::Host)
        }
    }

    /// Turns away foreign pages and who has not brought the token, from the websocket.
    pub fn socket(&self, headers: &HeaderMap, query: Option<&str>) -> Result<(), Refusal> {
        self.host(headers)?;
        if headers.contains_key(ORIGIN) {
            let origin = only(headers, &ORIGIN).ok_or(Refusal::Origin)?;
            let page = ["http://", "https://"]
                .iter()
                .find_map(|scheme| origin.strip_prefix(scheme));
            let page = page.and_then(name_of).ok_or(Refusal::Origin)?;
            let called = only(headers, &HOST).and_then(name_of);
            let is_near = self.loopback && is_loopback(&page);
            if !is_near && called != Some(page) {
                return Err(Refusal::Origin);
            }
        }
        let Some(token) = &self.token else {
            return Ok(());
        };
        let bearer = only(headers, &AUTHORIZATION).and_then(|text| text.strip_prefix("Bearer "));
        let asked = query
            .unwrap_or_default()
            .split('&')
            .find_map(|pair| pair.strip_prefix("token="));
        let brought = [only(headers, &TOKEN), bearer, asked];
        if brought
            .into_iter()
            .flatten()
            .any(|brought| same(brought, token))
        {
            Ok(())
        } else {
            Err(Refusal::Token)
        }
    }

    fn is_ours(&self, name: &str) -> bool {
        if self.loopback {
            return is_loopback(name);
        }
        // A number cannot be made to point elsewhere.
        let own = self.host.as_deref().is_some_and(|own| {
            let rest = name.strip_prefix(own);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        });
        own || name == "localhost" || name.parse::<IpAddr>().is_ok()
    }
}

/// The value of a header that is there once.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut all = headers.get_all(name).iter();
    let value = all.next()?.to_str().ok()?;
    all.next().is_none().then_some(value)
}

/// The name or number of `name`, `name:port` or `[number]:port`, in small letters; none for anything else.
fn name_of(authority: &str) -> Option<String> {
    let (name, port) = if let Some(rest) = authority.strip_prefix('[') {
        let (name, rest) = rest.split_once(']')?;
        (
            name,
            if rest.is_empty() {
                None
            } else {
                Some(rest.strip_prefix(':')?)
            },
        )
    } else {
        match authority.split_once(':') {
            Some((name, port)) => (name, Some(port)),
            None => (authority, None),
        }
    };
    let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | ':');
    let is_port = port.is_none_or(|port| port.parse::<u16>().is_ok());
    let name = name.to_lowercase();
    (is_port && !name.is_empty() && name.chars().all(known)).then_some(name)
}

fn is_loopback(name: &str) -> bool {
    name == "localhost" || name.parse().is_ok_and(super::is_loopback)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, value.parse().unwrap());
        }
        headers
    }

    fn near(pairs: &[(&'static str, &str)]) -> Result<(), Refusal> {
        Guard::new([127, 0, 0, 1].into(), None).socket(&headers(pairs), None)
    }

    #[test]
    fn on_loopback_only_loopback_pages_and_programs_may_call() {
        for origin in [
            None,
            Some("http://127.0.0.1:8080"),
            Some("http://localhost:5173"),
            Some("https://[::1]:1"),
        ] {
            let mut pairs = vec![("host", "127.0.0.1:8080")];
            pairs.extend(origin.map(|origin| ("origin", origin)));
            assert_eq!(near(&pairs), Ok(()), "{origin:?}");
        }
        for origin in [
            "https://example.org",
            "http://127.0.0.1.example.org",
            "http://localhost.example.org:8080",
            "http://example.org:8080",
            "null",
            "file://",
            "",
            "http://localhost:8080@example.org",
            "http://example.org#localhost",
        ] {
            let told = near(&[("host", "localhost:8080"), ("origin", origin)]);
            assert_eq!(told, Err(Refusal::Origin), "{origin}");
        }
    }

    #[test]
    fn a_name_that_was_made_to_point_here_is_refused() {
        for host in [
            "example.org",
            "example.org:8080",
            "127.0.0.1.example.org",
            "localhost.",
            "",
            "localhost:x",
        ] {
            let origin = format!("http://{host}");
            assert_eq!(
                near(&[("host", host), ("origin", &origin)]),
                Err(Refusal::Host),
                "{host}"
            );
        }
        assert_eq!(near(&[]), Err(Refusal::Host));
        let two = [("host", "localhost"), ("host", "example.org")];
        assert_eq!(near(&two), Err(Refusal::Host));
    }

    #[test]
    fn beyond_loopback_a_token_is_demanded_and_foreign_pages_are_refused() {
        let guard = Guard::new([0, 0, 0, 0].into(), Some("secret".to_owned()));
        let here = ("host", "192.0.2.7:8080");
        let told = |pairs: &[_], query| guard.socket(&headers(pairs), query);
        assert_eq!(told(&[here], None), Err(Refusal::Token));
        assert_eq!(told(&[here], Some("token=secreT")), Err(Refusal::Token));
        assert_eq!(told(&[here], Some("a=b&token=secret")), Ok(()));
        assert_eq!(told(&[here, ("x-poescope-token", "secret")], None), Ok(()));
        assert_eq!(
            told(&[here, ("authorization", "Bearer secret")], None),
            Ok(())
        );
        let own = ("origin", "http://192.0.2.7:9000");
        assert_eq!(told(&[here, own], Some("token=secret")), Ok(()));
        let foreign = ("origin", "http://localhost:9000");
        assert_eq!(
            told(&[here, foreign], Some("token=secret")),
            Err(Refusal::Origin)
        );
        let named = ("host", "example.org");
        assert_eq!(told(&[named], Some("token=secret")), Err(Refusal::Host));
    }
}
