//! Requests, read strictly: what is not plainly a request of the page is refused.

use std::io::{ErrorKind, Read};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Most bytes of a request: that of a browser has about one thousand. Our choice.
const MOST_BYTES: usize = 8192;
/// Time in which a request has to be there. Our choice; on one machine it is there at once.
pub(crate) const PATIENCE: Duration = Duration::from_secs(3);

/// A refusal: the number of the status and its words.
pub(crate) type Refusal = (u16, &'static str);

/// The request cannot be read.
const BAD: Refusal = (400, "Bad Request");
/// The request is none of the page.
const FORBIDDEN: Refusal = (403, "Forbidden");
/// The address leads to nothing.
pub(crate) const NOT_FOUND: Refusal = (404, "Not Found");

/// Where a server listens and what its addresses hold.
#[derive(Debug)]
pub(crate) struct Gate {
    /// Port on the loopback address.
    pub(crate) port: u16,
    /// What only those know who have the address.
    pub(crate) token: String,
}

/// What is asked for.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// The page.
    Page,
    /// Its parts.
    Data,
    /// The frame of a run, by key.
    Frame(String),
}

/// Reads a request up to the blank line, within a time and a size.
pub(crate) fn read_head(stream: &mut TcpStream) -> Result<Vec<u8>, Refusal> {
    let begin = Instant::now();
    let mut head = Vec::new();
    let mut part = [0; 2048];
    loop {
        let left = PATIENCE.saturating_sub(begin.elapsed());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return Err((408, "Request Timeout"));
        }
        let read = match stream.read(&mut part) {
            Ok(0) => return Err(BAD),
            Ok(read) => read,
            Err(why) if why.kind() == ErrorKind::Interrupted => continue,
            Err(_) => return Err((408, "Request Timeout")),
        };
        head.extend_from_slice(&part[..read]);
        if head.len() > MOST_BYTES {
            return Err((431, "Request Header Fields Too Large"));
        }
        if let Some(end) = head.windows(4).position(|four| four == b"\r\n\r\n") {
            // What follows would be a body, which no request of the page has.
            return if end + 4 == head.len() {
                head.truncate(end);
                Ok(head)
            } else {
                Err(BAD)
            };
        }
    }
}

impl Gate {
    /// The address of the page.
    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// What a request asks for.
    ///
    /// # Errors
    ///
    /// A refusal of a request that is none of the page: of another method, host or origin, with a body, without the token, or for
    /// what there is not.
    pub(crate) fn asked(&self, head: &[u8]) -> Result<Asked, Refusal> {
        let is_plain = |byte: &u8| matches!(byte, b' '..=b'~' | b'\r' | b'\n');
        let head = std::str::from_utf8(head).map_err(|_| BAD)?;
        if !head.as_bytes().iter().all(is_plain) {
            return Err(BAD);
        }
        let mut lines = head.split("\r\n");
        let parts: Vec<&str> = lines.next().unwrap_or_default().split(' ').collect();
        let [method, target, version] = parts.as_slice() else {
            return Err(BAD);
        };
        if *method != "GET" {
            return Err((405, "Method Not Allowed"));
        }
        if *version != "HTTP/1.1" {
            return Err((505, "HTTP Version Not Supported"));
        }
        let mut hosts = 0;
        for line in lines {
            let (name, value) = line.split_once(':').ok_or(BAD)?;
            let is_name = |b: u8| b.is_ascii_alphanumeric() || b"!#$%&'*+-.^_`|~".contains(&b);
            if name.is_empty() || !name.bytes().all(is_name) || line.contains(['\r', '\n']) {
                return Err(BAD);
            }
            let value = value.trim_matches(' ');
            match name.to_ascii_lowercase().as_str() {
                "host" => {
                    hosts += 1;
                    if !self.is_own(value) {
                        return Err(FORBIDDEN);
                    }
                }
                "origin" => {
                    let host = value.strip_prefix("http://").unwrap_or_default();
                    if !self.is_own(host) {
                        return Err(FORBIDDEN);
                    }
                }
                "content-length" if value == "0" => {}
                "content-length" | "transfer-encoding" | "expect" | "upgrade" => return Err(BAD),
                _ => {}
            }
        }
        if hosts != 1 {
            return Err(BAD);
        }
        self.target(target)
    }

    /// What a target with the token asks for.
    fn target(&self, target: &str) -> Result<Asked, Refusal> {
        let rest = target.strip_prefix('/').ok_or(BAD)?;
        let (token, rest) = rest.split_once('/').ok_or(NOT_FOUND)?;
        if !is_same(token.as_bytes(), self.token.as_bytes()) {
            return Err(NOT_FOUND);
        }
        match rest {
            "" => Ok(Asked::Page),
            "data.json" => Ok(Asked::Data),
            _ => match rest.strip_prefix("frame/") {
                Some(key) => Ok(Asked::Frame(key.to_owned())),
                None => Err(NOT_FOUND),
            },
        }
    }

    /// Whether this is the name of the server.
    fn is_own(&self, host: &str) -> bool {
        let named = |name: &str| host == format!("{name}:{}", self.port);
        named("127.0.0.1") || named("localhost")
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    let differences = a.iter().zip(b).fold(0, |sum, (x, y)| sum | (x ^ y));
    a.len() == b.len() && differences == 0
}
