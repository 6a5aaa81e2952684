//! A server of a few files on the loopback address.
//!
//! It answers GET and HEAD, a connection a request. Pages of other origins get nothing: a request has to name the address as its host,
//! and no other origin may embed the files.

use anyhow::Context;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

/// Most bytes of the head of a request.
const MOST: usize = 8192;

/// How long a connection may keep silent.
const PATIENCE: Duration = Duration::from_secs(10);

/// Files by name.
type Files = Vec<(&'static str, Vec<u8>)>;

/// A server whose port is open.
pub struct Server {
    listener: TcpListener,
    port: u16,
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
        Ok(Self { listener, port })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Answers for ever.
    pub fn run(self, files: Files) -> anyhow::Result<()> {
        let (files, port) = (Arc::new(files), self.port);
        for stream in self.listener.incoming() {
            let files = Arc::clone(&files);
            // A connection that fails is the browser's to repeat.
            let Ok(stream) = stream else { continue };
            // A browser opens connections before it needs them: each waits by itself.
            std::thread::Builder::new()
                .spawn(move || answer(stream, &files, port))
                .context("no thread for a request")?;
        }
        Ok(())
    }
}

/// Answers a request.
fn answer(mut stream: TcpStream, files: &Files, port: u16) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut head = Vec::new();
    let mut part = [0; 1024];
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        let count = stream.read(&mut part)?;
        if count == 0 || head.len() + count > MOST {
            return Ok(());
        }
        head.extend_from_slice(&part[..count]);
    }
    let (status, kind, body) = found(&String::from_utf8_lossy(&head), files, port);
    let mut text = format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
    text += "Cache-Control: no-store\r\nCross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n";
    stream.write_all(text.as_bytes())?;
    if !head.starts_with(b"HEAD ") {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// The answer to the head of a request: status, type and content.
fn found<'f>(head: &str, files: &'f Files, port: u16) -> (&'static str, &'static str, &'f [u8]) {
    const PLAIN: &str = "text/plain; charset=utf-8";
    let mut lines = head.lines();
    let mut request = lines.next().unwrap_or_default().split(' ');
    let (method, path) = (request.next().unwrap_or_default(), request.next().unwrap_or_default());
    if !["GET", "HEAD"].contains(&method) {
        return ("405 Method Not Allowed", PLAIN, b"only files are given\n");
    }
    let host =
        lines.filter_map(|line| line.split_once(':')).find(|(name, _)| name.eq_ignore_ascii_case("host"));
    let host = host.map_or("", |(_, value)| value.trim());
    if host != format!("127.0.0.1:{port}") && host != format!("localhost:{port}") {
        return ("403 Forbidden", PLAIN, b"the host is not this one\n");
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
    }

    #[test]
    fn other_hosts_get_nothing() {
        for host in ["example.org", "127.0.0.1:81", "127.0.0.1", ""] {
            assert_eq!(status(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n")), "403 Forbidden", "{host}");
        }
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "403 Forbidden");
        assert_eq!(status("GET / HTTP/1.1\r\nhost: localhost:80\r\n\r\n"), "200 OK");
    }

    #[test]
    fn a_request_is_answered_over_a_connection() {
        let server = Server::bind(0).unwrap();
        let port = server.port;
        assert_eq!(server.address(), format!("http://127.0.0.1:{port}/"));
        std::thread::spawn(move || server.run(files()));
        let ask = |head: &str| {
            let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
            stream.write_all(head.as_bytes()).unwrap();
            let mut text = String::new();
            stream.read_to_string(&mut text).unwrap();
            text
        };
        let text = ask(&format!("GET /page.js HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n"));
        assert!(text.starts_with("HTTP/1.1 200 OK\r\n") && text.ends_with("\r\n\r\nscript"), "{text}");
        let text = ask(&format!("HEAD / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n"));
        assert!(text.contains("Content-Length: 4") && text.ends_with("\r\n\r\n"), "{text}");
        // A port that is taken is an error.
        assert!(Server::bind(port).is_err());
    }
}
