//! A server of a few files on the loopback address, which answers questions of its page.
//!
//! It answers GET and HEAD, a connection a request. POST asks a question about a file, which is its content: its answer is lines with the
//! share that is done, then `done` and the length of a text, the text, and bytes; or `error` and a sentence. Pages of other origins get
//! nothing: a request has to name the address as its host, a question as its origin too, and no other origin may embed the files. Clients
//! have [`Bounds`], and none of them ends the server.

use anyhow::{Context, ensure};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::mpsc::sync_channel;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The room and the time that clients may take.
#[derive(Clone, Copy)]
struct Bounds {
    /// Connections that are answered at a time, each by a thread. Others wait in the queue of the system.
    clients: usize,
    /// Time for the whole head.
    asking: Duration,
    /// Time for the whole answer: through a slow tunnel the page takes a minute.
    answering: Duration,
    /// Pause after a connection that the system could not give, as where too many files are open.
    pause: Duration,
}

/// A browser opens six connections, some before it needs them.
const BOUNDS: Bounds = Bounds {
    clients: 32,
    asking: Duration::from_secs(10),
    answering: Duration::from_secs(120),
    pause: Duration::from_millis(100),
};

/// Most bytes of the head of a request.
const HEAD: usize = 8192;

/// Most bytes of the content of a question.
const CONTENT: usize = 1 << 28;

/// Files by name.
pub type Files = Vec<(&'static str, Vec<u8>)>;

/// A question of the page: a verb, the name of a file or a format, and the bytes of the file. It tells the share that is done.
pub type Ask<'a> =
    dyn Fn(&str, &str, &[u8], &mut (dyn FnMut(f64) + Send)) -> Result<(String, Vec<u8>), String> + Sync + 'a;

/// A server whose port is open.
pub struct Server {
    listener: TcpListener,
    port: u16,
    bounds: Bounds,
}

impl Server {
    /// Opens a port of the loopback address, 0 for any.
    ///
    /// # Errors
    /// Where it is taken, or not allowed.
    pub fn bind(port: u16) -> anyhow::Result<Self> {
        let bound = TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = bound.with_context(|| format!("--port {port}: a free port is expected"))?;
        let port = listener.local_addr()?.port();
        Ok(Self { listener, port, bounds: BOUNDS })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Answers for ever.
    ///
    /// # Errors
    /// Where there is no thread at all for requests.
    pub fn run(self, files: &Files, ask: &Ask<'_>) -> anyhow::Result<()> {
        let Self { listener, port, bounds } = self;
        // Without room: a connection is handed over where a thread is free for it.
        let (give, taken) = sync_channel::<TcpStream>(0);
        let taken = Mutex::new(taken);
        let next = || taken.lock().unwrap_or_else(PoisonError::into_inner).recv();
        // A fit takes all processors: one question at a time.
        let ask = Mutex::new(ask);
        let work = || {
            while let Ok(stream) = next() {
                // A connection that fails is the browser's to repeat.
                let _ = answer(stream, files, &ask, port, bounds);
            }
        };
        std::thread::scope(|scope| {
            let thread = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
            let threads = (0..bounds.clients).map_while(thread).count();
            ensure!(threads > 0, "no thread for requests");
            loop {
                match listener.accept() {
                    Ok((stream, _)) => give.send(stream)?,
                    Err(_) => std::thread::sleep(bounds.pause),
                }
            }
        })
    }
}

/// A connection until an end.
struct Timed {
    stream: TcpStream,
    end: Instant,
}

impl Timed {
    /// The time that is left.
    fn left(&self) -> io::Result<Option<Duration>> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(Some(left)) }
    }
}

impl Read for Timed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(bytes)
    }
}

impl Write for Timed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Answers a request.
fn answer(
    stream: TcpStream,
    files: &Files,
    ask: &Mutex<&Ask<'_>>,
    port: u16,
    bounds: Bounds,
) -> io::Result<()> {
    let mut stream = Timed { stream, end: Instant::now() + bounds.asking };
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    while head.len() <= HEAD && !head.windows(4).any(|end| end == b"\r\n\r\n") {
        let count = stream.read(&mut part)?;
        if count == 0 {
            return Ok(());
        }
        head.extend_from_slice(&part[..count]);
    }
    let (status, kind, body) = match asked(&head, files, port) {
        Ok((question, end)) => {
            let begun = head.split_off(end);
            return answer_question(stream, &question, begun, ask, bounds);
        }
        Err(answer) => answer,
    };
    let mut text = format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
    text += "Cache-Control: no-store\r\nCross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n";
    stream.end = Instant::now() + bounds.answering;
    stream.write_all(text.as_bytes())?;
    if !head.starts_with(b"HEAD ") {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// Status, type and content.
type Answer<'f> = (&'static str, &'static str, &'f [u8]);

/// The question that bytes begin with and where its content begins, or the answer to other bytes.
///
/// # Errors
/// The answer, of those that are no question.
pub fn asked<'f>(head: &[u8], files: &'f Files, port: u16) -> Result<(Question, usize), Answer<'f>> {
    let end = head.windows(4).position(|end| end == b"\r\n\r\n");
    let asked = end.and_then(|end| question(&String::from_utf8_lossy(&head[..end]), port, CONTENT));
    Err(match (asked, end) {
        (Some(Ok(question)), Some(end)) => return Ok((question, end + 4)),
        (Some(Err((status, body))), _) => (status, PLAIN, body.as_bytes()),
        _ if head.len() > HEAD => {
            ("431 Request Header Fields Too Large", PLAIN, &b"the head is too long\n"[..])
        }
        _ => found(&String::from_utf8_lossy(head), files, port),
    })
}

/// A question of the page.
pub struct Question {
    /// `open` or `export`.
    pub verb: String,
    /// The name of a file, or a format.
    pub with: String,
    /// Bytes of the content.
    pub length: usize,
}

/// The question of the head of a request; `None` for a request of another kind, and an error with its status for one that is refused.
fn question(head: &str, port: u16, most: usize) -> Option<Result<Question, (&'static str, &'static str)>> {
    let mut lines = head.lines();
    let path = lines.next()?.strip_prefix("POST /")?.split(' ').next()?;
    let (verb, with) = path.split_once('?').filter(|(verb, _)| ["open", "export"].contains(verb))?;
    let fields: Vec<_> = lines.filter_map(|line| line.split_once(':')).collect();
    let field = |wanted: &str| fields.iter().find(|(name, _)| name.eq_ignore_ascii_case(wanted));
    let field = |wanted: &str| field(wanted).map_or("", |(_, value)| value.trim());
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let is_own = own.iter().any(|own| field("host") == own && field("origin") == format!("http://{own}"));
    if !is_own {
        return Some(Err(("403 Forbidden", "the page of this server alone may ask\n")));
    }
    let length = field("content-length").parse().ok().filter(|length| *length <= most);
    let Some(length) = length.filter(|_| field("transfer-encoding").is_empty()) else {
        return Some(Err(("413 Content Too Large", "a file of at most 268435456 bytes is expected\n")));
    };
    Some(Ok(Question { verb: verb.to_owned(), with: unescaped(with), length }))
}

/// A text in which bytes are written as %XX.
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut parts = text.split('%');
    bytes.extend_from_slice(parts.next().unwrap_or_default().as_bytes());
    for part in parts {
        let byte = part.get(..2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(byte.unwrap_or(b'%'));
        bytes
            .extend_from_slice(part.as_bytes().get(if byte.is_some() { 2 } else { 0 }..).unwrap_or_default());
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads the content of a question, asks, and writes the answer as it comes.
fn answer_question(
    mut stream: Timed,
    question: &Question,
    mut content: Vec<u8>,
    ask: &Mutex<&Ask<'_>>,
    bounds: Bounds,
) -> io::Result<()> {
    // One content in memory at a time.
    let ask = ask.lock().unwrap_or_else(PoisonError::into_inner);
    stream.end = Instant::now() + bounds.answering;
    let mut part = [0; 1 << 16];
    while content.len() < question.length {
        let count = stream.read(&mut part)?;
        if count == 0 {
            return Ok(());
        }
        content.extend_from_slice(&part[..count]);
    }
    content.truncate(question.length);
    let head = "HTTP/1.1 200 OK\r\nContent-Type: application/octet-stream\r\nCache-Control: no-store\r\nCross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n";
    let mut write = |bytes: &[u8]| {
        stream.end = Instant::now() + bounds.answering;
        stream.write_all(bytes)
    };
    write(head.as_bytes())?;
    let mut told = 0.0;
    let mut progress = |share: f64| {
        if share >= told + 0.01 || share >= 1.0 {
            told = share;
            // Who went away is not told; the fit ends by itself.
            let _ = write(format!("share {share:.3}\n").as_bytes());
        }
    };
    let answer = (*ask)(&question.verb, &question.with, &content, &mut progress);
    match answer {
        Ok((text, bytes)) => {
            write(format!("done {}\n{text}", text.len()).as_bytes())?;
            write(&bytes)
        }
        Err(text) => write(format!("error {}\n", text.replace('\n', " ")).as_bytes()),
    }
}

/// The type of messages.
const PLAIN: &str = "text/plain; charset=utf-8";

/// The answer to the head of a request.
fn found<'f>(head: &str, files: &'f Files, port: u16) -> Answer<'f> {
    let mut lines = head.lines();
    let mut request = lines.next().unwrap_or_default().split(' ');
    let (method, path) = (request.next().unwrap_or_default(), request.next().unwrap_or_default());
    if !["GET", "HEAD"].contains(&method) {
        return ("405 Method Not Allowed", PLAIN, b"files are given, and questions of the page answered\n");
    }
    let fields: Vec<_> = lines.filter_map(|line| line.split_once(':')).collect();
    let field = |wanted: &str| fields.iter().find(|(name, _)| name.eq_ignore_ascii_case(wanted));
    let field = |wanted: &str| field(wanted).map_or("", |(_, value)| value.trim());
    let host = field("host");
    if host != format!("127.0.0.1:{port}") && host != format!("localhost:{port}") {
        return ("403 Forbidden", PLAIN, b"the host is not this one\n");
    }
    if !["", "0"].contains(&field("content-length")) || !field("transfer-encoding").is_empty() {
        return ("413 Content Too Large", PLAIN, b"a request without content is expected\n");
    }
    let name = path.split(['?', '#']).next().unwrap_or_default().trim_start_matches('/');
    let name = if name.is_empty() { "index.html" } else { name };
    match files.iter().find(|file| file.0 == name) {
        Some((_, content)) => ("200 OK", kind(name), content),
        None => ("404 Not Found", PLAIN, b"there is no such file\n"),
    }
}

/// The type of a file by its ending.
fn kind(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "html" => "text/html; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> Files {
        vec![("index.html", b"page".to_vec()), ("page.js", b"script".to_vec())]
    }

    fn status(head: &str) -> &'static str {
        found(head, &files(), 80).0
    }

    #[test]
    fn files_are_found_by_name_and_nothing_else_is() {
        let get = |path: &str| format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n");
        let of = files();
        assert_eq!(found(&get("/"), &of, 80), ("200 OK", "text/html; charset=utf-8", &b"page"[..]));
        assert_eq!(found(&get("/page.js?x"), &of, 80).2, b"script");
        for path in ["/other", "/../page.js", "//etc/passwd", "/page.js/"] {
            assert_eq!(status(&get(path)), "404 Not Found", "{path}");
        }
        assert_eq!(status("POST / HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n"), "405 Method Not Allowed");
        assert_eq!(status(""), "405 Method Not Allowed");
        for (field, expected) in [
            ("Content-Length: 0", "200 OK"),
            ("content-length: 9", "413 Content Too Large"),
            ("Transfer-Encoding: chunked", "413 Content Too Large"),
        ] {
            assert_eq!(status(&format!("GET / HTTP/1.1\r\nHost: localhost:80\r\n{field}\r\n\r\n")), expected);
        }
    }

    #[test]
    fn other_hosts_get_nothing() {
        for host in ["example.org", "127.0.0.1:81", "127.0.0.1", ""] {
            assert_eq!(status(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n")), "403 Forbidden", "{host}");
        }
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "403 Forbidden");
        assert_eq!(status("GET / HTTP/1.1\r\nhost: localhost:80\r\n\r\n"), "200 OK");
    }

    /// A server of these bounds; its port.
    fn start(bounds: Bounds, files: Files) -> u16 {
        let server = Server { bounds, ..Server::bind(0).unwrap() };
        let port = server.port;
        assert_eq!(server.address(), format!("http://127.0.0.1:{port}/"));
        std::thread::spawn(move || {
            server.run(&files, &|verb, with, bytes, progress| {
                progress(0.5);
                match verb {
                    "open" => Ok((format!("{with}: {}", bytes.len()), bytes.to_vec())),
                    _ => Err(format!("{with} is\nno format")),
                }
            })
        });
        port
    }

    fn connected(port: u16) -> TcpStream {
        let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    fn get(port: u16, path: &str) -> String {
        format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n")
    }

    /// All that is answered until the connection ends, by the server or by the fault that it had to end with.
    fn answered(mut stream: TcpStream, head: &str) -> String {
        let _ = stream.write_all(head.as_bytes());
        let mut bytes = Vec::new();
        let end = stream.read_to_end(&mut bytes);
        assert!(!end.is_err_and(|error| error.kind() == io::ErrorKind::WouldBlock), "no end in a minute");
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn a_request_is_answered_over_a_connection() {
        let port = start(BOUNDS, files());
        let text = answered(connected(port), &get(port, "/page.js"));
        assert!(text.starts_with("HTTP/1.1 200 OK\r\n") && text.ends_with("\r\n\r\nscript"), "{text}");
        let text = answered(connected(port), &get(port, "/").replace("GET", "HEAD"));
        assert!(text.contains("Content-Length: 4") && text.ends_with("\r\n\r\n"), "{text}");
        // A port that is taken is an error.
        assert!(Server::bind(port).is_err());
    }

    #[test]
    fn questions_of_the_page_are_answered() {
        let port = start(BOUNDS, files());
        let post = |path: &str, origin: &str, content: &str| {
            let length = content.len();
            let head = format!(
                "POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: {origin}\r\nContent-Length: {length}\r\n\r\n{content}"
            );
            answered(connected(port), &head)
        };
        let own = format!("http://127.0.0.1:{port}");
        let text = post("/open?a%20%C3%A4%zz.csv", &own, "samples");
        assert!(text.ends_with("\r\n\r\nshare 0.500\ndone 14\na \u{e4}%zz.csv: 7samples"), "{text}");
        let text = post("/export?x", &own, "");
        assert!(text.ends_with("share 0.500\nerror x is no format\n"), "{text}");
        // Of other pages, and of none.
        for origin in ["http://example.org", "null", "", "http://127.0.0.1:1"] {
            assert!(post("/open?a", origin, "x").starts_with("HTTP/1.1 403 "), "{origin}");
        }
        assert!(post("/other?a", &own, "x").starts_with("HTTP/1.1 405 "));
        let head = |length: &str| {
            format!(
                "POST /open?a HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: {own}\r\nContent-Length: {length}\r\n\r\n"
            )
        };
        for length in ["268435457", "-1", "99999999999999999999", "x", ""] {
            assert!(answered(connected(port), &head(length)).starts_with("HTTP/1.1 413 "), "{length}");
        }
    }

    /// Little time for each part.
    const SHORT: Bounds = Bounds {
        clients: 2,
        asking: Duration::from_millis(300),
        answering: Duration::from_millis(300),
        ..BOUNDS
    };

    #[test]
    fn more_clients_than_threads_take_turns() {
        let port = start(SHORT, files());
        let silent: Vec<TcpStream> = (0..10).map(|_| connected(port)).collect();
        // Behind five pairs, each of which has its time.
        let start = Instant::now();
        assert!(answered(connected(port), &get(port, "/")).ends_with("page"));
        assert!(start.elapsed() > 3 * SHORT.asking, "{:?}", start.elapsed());
        drop(silent);
    }

    #[test]
    fn a_head_comes_in_its_time_and_is_not_long() {
        let port = start(SHORT, files());
        let mut slow = connected(port);
        let start = Instant::now();
        // Each byte comes long before the end, all of them never.
        while slow.write_all(b"G").is_ok() && start.elapsed() < Duration::from_secs(30) {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert!(start.elapsed() < Duration::from_secs(30), "a slow sender is never left");
        let long = get(port, &format!("/{}", "a".repeat(HEAD)));
        assert!(answered(connected(port), &long).starts_with("HTTP/1.1 431 "));
        // One that never ends is not read to its end.
        let mut endless = connected(port);
        let part = [b'a'; 1 << 16];
        let parts = (0..1 << 14).take_while(|_| endless.write_all(&part).is_ok()).count();
        assert!(parts < 1 << 14, "a gigabyte was taken");
    }

    #[test]
    fn an_answer_is_taken_in_its_time() {
        let large = 1 << 26;
        let port = start(SHORT, vec![("index.html", vec![b'a'; large])]);
        let mut slow = connected(port);
        slow.write_all(get(port, "/").as_bytes()).unwrap();
        let (mut count, mut part) = (0, [0; 1 << 16]);
        // Each part is taken long before the end, all of them never.
        while let Ok(size @ 1..) = slow.read(&mut part) {
            count += size;
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(count < large, "a slow reader got {count} bytes");
    }
}
