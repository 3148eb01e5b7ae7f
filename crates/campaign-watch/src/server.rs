//! Serving the page to those who have its address.

use std::fmt;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::folder::CampaignFolder;
use crate::request::{Asked, Gate, NOT_FOUND, PATIENCE, Refusal, read_head};
use crate::{Error, page, view};

/// Pause between two looks for a client.
const PAUSE: Duration = Duration::from_millis(25);
/// Most clients at a time; one that comes on top is turned away. Our choice: a browser has six connections.
const MOST_CLIENTS: usize = 64;
/// Least time between two looks into the folder, however many pages are open. Our choice.
const LEAST_AGE: Duration = Duration::from_secs(1);
/// Most bytes of a refused request that are read, so that its client reads the refusal.
const MOST_LEFT_OVER: u64 = 1 << 20;

/// A server on the loopback address.
pub struct Server {
    /// Where clients come.
    listener: TcpListener,
    /// What its clients share.
    hall: Arc<Hall>,
}

/// What all clients share.
struct Hall {
    /// Who is let in.
    gate: Gate,
    /// What is shown.
    shown: Mutex<Shown>,
    /// Number of clients at present.
    clients: AtomicUsize,
    /// Done before each reply to the script of the page, for tests that let a campaign go on.
    #[cfg(test)]
    before_data: Mutex<Option<Box<dyn FnMut() + Send>>>,
}

/// What is shown.
struct Shown {
    /// The folder.
    folder: CampaignFolder,
    /// Least time between two looks into it.
    least_age: Duration,
    /// The last look: when, the title, the parts.
    last: Option<(Instant, String, view::Parts)>,
}

/// A reply with its type.
struct Reply {
    /// Number and words of the status.
    status: Refusal,
    /// Type of the content.
    kind: &'static str,
    /// The content.
    content: Vec<u8>,
}

impl fmt::Debug for Server {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the token.
        f.debug_struct("Server")
            .field("port", &self.hall.gate.port)
            .finish_non_exhaustive()
    }
}

impl Server {
    /// Listens on a port of the loopback address; 0 for a free one.
    ///
    /// # Errors
    ///
    /// [`Error::Port`], [`Error::Randomness`].
    pub fn bind(folder: CampaignFolder, port: u16) -> Result<Self, Error> {
        let failed = |source| Error::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let port = listener.local_addr().map_err(failed)?.port();
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|why| Error::Randomness {
            reason: why.to_string(),
        })?;
        let token = format!("{:032x}", u128::from_ne_bytes(bytes));
        let hall = Hall {
            gate: Gate { port, token },
            shown: Mutex::new(Shown {
                folder,
                least_age: LEAST_AGE,
                last: None,
            }),
            clients: AtomicUsize::new(0),
            #[cfg(test)]
            before_data: Mutex::new(None),
        };
        Ok(Self {
            listener,
            hall: Arc::new(hall),
        })
    }

    /// The address of the page, with the token.
    pub fn address(&self) -> String {
        self.hall.gate.address()
    }

    /// Serves until the flag is raised, and returns within a tenth of a second then.
    pub fn serve(&self, stop: &AtomicBool) {
        while !stop.load(Ordering::SeqCst) {
            match self.listener.accept() {
                Ok((stream, _)) => self.receive(stream),
                // Nobody is there, or the client has gone again.
                Err(_) => std::thread::sleep(PAUSE),
            }
        }
    }

    /// Gives a client a thread of its own, so that a slow one holds up nobody else.
    fn receive(&self, stream: TcpStream) {
        let hall = Arc::clone(&self.hall);
        if hall.clients.fetch_add(1, Ordering::SeqCst) >= MOST_CLIENTS {
            hall.clients.fetch_sub(1, Ordering::SeqCst);
            return;
        }
        let guest = Guest(hall);
        // A system without threads to spare turns the client away.
        let _ = std::thread::Builder::new().spawn(move || guest.0.attend(stream));
    }

    /// Looks into the folder for each reply, after doing something.
    #[cfg(test)]
    pub(crate) fn before_data(&self, what: impl FnMut() + Send + 'static) {
        self.hall.shown.lock().unwrap().least_age = Duration::ZERO;
        *self.hall.before_data.lock().unwrap() = Some(Box::new(what));
    }
}

/// A client that is counted as long as it is there.
struct Guest(Arc<Hall>);

impl Drop for Guest {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Hall {
    /// Reads the request of a client and replies; one that has gone gets nothing.
    fn attend(&self, mut stream: TcpStream) {
        if stream.set_nonblocking(false).is_err() {
            return;
        }
        let asked = read_head(&mut stream).and_then(|head| self.gate.asked(&head));
        let is_refused = asked.is_err();
        let reply = asked.and_then(|asked| self.reply(&asked));
        let reply = reply.unwrap_or_else(refusal);
        if send(&mut stream, &reply).is_ok()
            && stream.shutdown(Shutdown::Write).is_ok()
            && is_refused
        {
            // A connection that is closed over unread bytes takes the reply with it.
            let _ = stream.set_read_timeout(Some(Duration::from_millis(200)));
            let mut rest = stream.take(MOST_LEFT_OVER);
            let mut part = [0; 4096];
            let begin = Instant::now();
            while begin.elapsed() < PATIENCE && rest.read(&mut part).is_ok_and(|read| read > 0) {}
        }
    }

    /// What is asked for.
    fn reply(&self, asked: &Asked) -> Result<Reply, Refusal> {
        #[cfg(test)]
        if *asked == Asked::Data
            && let Some(what) = self.before_data.lock().unwrap().as_mut()
        {
            what();
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let (kind, content) = match asked {
            Asked::Page => {
                let (title, parts) = shown.look();
                (
                    "text/html; charset=utf-8",
                    page::html(title, parts).into_bytes(),
                )
            }
            Asked::Data => {
                let (title, parts) = shown.look();
                ("application/json", page::json(title, parts).into_bytes())
            }
            Asked::Frame(key) => {
                let frame = shown.folder.frame(key).ok_or(NOT_FOUND)?;
                ("image/png", frame.to_vec())
            }
        };
        Ok(Reply {
            status: (200, "OK"),
            kind,
            content,
        })
    }
}

impl Shown {
    /// Title and parts; of a new look where the last one is old.
    fn look(&mut self) -> (&String, &view::Parts) {
        let is_young = |(then, ..): &(Instant, _, _)| then.elapsed() < self.least_age;
        let last = self.last.take().filter(is_young).unwrap_or_else(|| {
            let (title, parts) = view::parts(&self.folder.look());
            (Instant::now(), title, parts)
        });
        let (_, title, parts) = self.last.insert(last);
        (title, parts)
    }
}

/// The reply of a refusal.
fn refusal(status: Refusal) -> Reply {
    Reply {
        status,
        kind: "text/plain; charset=utf-8",
        content: format!("{} {}\n", status.0, status.1).into_bytes(),
    }
}

/// Writes a reply, within a time.
fn send(stream: &mut TcpStream, reply: &Reply) -> std::io::Result<()> {
    let (number, words) = reply.status;
    let allow = if number == 405 { "Allow: GET\r\n" } else { "" };
    let mut bytes = format!(
        "HTTP/1.1 {number} {words}\r\n{allow}Content-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nContent-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n\
         X-Frame-Options: DENY\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\n\r\n",
        reply.kind,
        reply.content.len(),
        page::policy()
    )
    .into_bytes();
    bytes.extend_from_slice(&reply.content);
    let begin = Instant::now();
    let mut left = bytes.as_slice();
    while !left.is_empty() {
        let time = PATIENCE.saturating_sub(begin.elapsed());
        if time.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_write_timeout(Some(time))?;
        match stream.write(left) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(written) => left = &left[written..],
            Err(why) if why.kind() == ErrorKind::Interrupted => {}
            Err(why) => return Err(why),
        }
    }
    Ok(())
}
